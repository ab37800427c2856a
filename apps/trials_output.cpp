#include "apps/trials_output.h"

namespace flatspeckle::apps {

namespace {

void write_count(ResultFile& file, const std::string& name, std::uint64_t count,
                 const std::string& long_name) {
  file.dataset("trials/" + name, std::vector<std::uint64_t>{count}, {}, "1", long_name);
}

}  // namespace

void write_trials(ResultFile& file, const grin::ConnectionStatistics& statistics) {
  static constexpr const char* outcomes[grin::trial_outcomes] = {
      "converged", "no_approach", "not_converged", "left_region", "too_long", "degenerate"};
  for (int i = 0; i < grin::trial_outcomes; ++i)
    write_count(file, outcomes[i], statistics.outcomes[i], "trials that ended so");
  write_count(file, "iterations", statistics.iterations, "Gauss-Newton steps of all trials");
}

void write_pairs(ResultFile& file, const grin::ConnectionStatistics& statistics) {
  write_count(file, "pairs", statistics.pairs, "pairs of points that a curve was sought between");
  write_count(file, "found", statistics.found, "pairs whose first trial found one");
  write_count(file, "further", statistics.refind, "further trials until a curve was found again");
  write_count(file, "roulette_ends", statistics.roulette_ends, "searches that roulette ended");
}

}  // namespace flatspeckle::apps

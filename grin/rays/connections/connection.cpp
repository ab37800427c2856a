#include "grin/rays/connections/connection.h"

#include <algorithm>
#include <numeric>

#include "core/result/result_group.h"
namespace flatspeckle::grin {

namespace {

double ratio(std::uint64_t part, std::uint64_t all) {
  return all ? static_cast<double>(part) / static_cast<double>(all) : 0;
}

}  // namespace

std::uint64_t ConnectionStatistics::trials() const {
  return std::accumulate(outcomes.begin(), outcomes.end(), std::uint64_t{0});
}

double ConnectionStatistics::success_rate() const {
  return ratio(count(TrialOutcome::converged), trials());
}
double ConnectionStatistics::iterations_per_trial() const {
  return ratio(iterations, trials());
}
double ConnectionStatistics::mean_refind() const {
  return ratio(refind, found);
}

void ConnectionStatistics::record_refind(std::uint64_t further_trials) {
  refind += further_trials;
  refind_max = std::max(refind_max, further_trials);
}

ConnectionStatistics& ConnectionStatistics::operator+=(const ConnectionStatistics& other) {
  for (std::size_t i = 0; i < outcomes.size(); ++i) outcomes[i] += other.outcomes[i];
  iterations += other.iterations;
  guess_steps += other.guess_steps;
  rough_steps += other.rough_steps;
  tangent_steps += other.tangent_steps;
  pairs += other.pairs;
  found += other.found;
  refind += other.refind;
  refind_max = std::max(refind_max, other.refind_max);
  roulette_ends += other.roulette_ends;
  return *this;
}

bool same_curve(const Connection& a, const Connection& b, double tolerance) {
  const double length = std::max(a.arc_length, b.arc_length);
  return a.orientation == b.orientation &&
         (a.start_direction - b.start_direction).norm() <= tolerance &&
         std::abs(a.arc_length - b.arc_length) <= tolerance * length;
}

const DatasetTable trials_table{
    "trials",
    {{"trials/converged", Data::count, "", "1", "trials that ended so"},
     {"trials/no_approach", Data::count, "", "1", "trials that ended so"},
     {"trials/not_converged", Data::count, "", "1", "trials that ended so"},
     {"trials/left_region", Data::count, "", "1", "trials that ended so"},
     {"trials/too_long", Data::count, "", "1", "trials that ended so"},
     {"trials/degenerate", Data::count, "", "1", "trials that ended so"},
     {"trials/iterations", Data::count, "", "1", "Gauss-Newton steps of all trials"},
     {"trials/pairs", Data::count, "", "1", "pairs of points that a curve was sought between"},
     {"trials/found", Data::count, "", "1", "pairs whose first trial found one"},
     {"trials/further", Data::count, "", "1", "further trials until a curve was found again"},
     {"trials/roulette_ends", Data::count, "", "1", "searches that roulette ended"}}};

void write_trials(ResultFile& file, const ConnectionStatistics& statistics) {
  const ResultGroup root(file, trials_table);
  for (std::size_t i = 0; i < trial_outcomes; ++i)  // the first rows
    root.put(trials_table.rows[i].path, statistics.outcomes[i]);
  root.put("trials/iterations", statistics.iterations);
}

void write_pairs(ResultFile& file, const ConnectionStatistics& statistics) {
  const ResultGroup root(file, trials_table);
  root.put("trials/pairs", statistics.pairs);
  root.put("trials/found", statistics.found);
  root.put("trials/further", statistics.refind);
  root.put("trials/roulette_ends", statistics.roulette_ends);
}

}  // namespace flatspeckle::grin

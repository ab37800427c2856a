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
double ConnectionStatistics::mean_trials() const {
  return ratio(further, found);
}

void ConnectionStatistics::record_trials(std::uint64_t further_trials) {
  further += further_trials;
  most_trials_of_one = std::max(most_trials_of_one, further_trials);
}

ConnectionStatistics& ConnectionStatistics::operator+=(const ConnectionStatistics& other) {
  for (std::size_t i = 0; i < outcomes.size(); ++i) outcomes[i] += other.outcomes[i];
  iterations += other.iterations;
  guess_steps += other.guess_steps;
  rough_steps += other.rough_steps;
  tangent_steps += other.tangent_steps;
  pairs += other.pairs;
  found += other.found;
  further += other.further;
  most_trials_of_one = std::max(most_trials_of_one, other.most_trials_of_one);
  roulette_terminations += other.roulette_terminations;
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
    {{"trials/converged", Data::count, "", "1", "number of trials that converged to a curve"},
     {"trials/no_approach", Data::count, "", "1",
      "number of trials whose first ray never approaches the second point"},
     {"trials/not_converged", Data::count, "", "1",
      "number of trials whose corrections do not converge"},
     {"trials/left_region", Data::count, "", "1", "number of trials whose curve leaves the region"},
     {"trials/too_long", Data::count, "", "1",
      "number of trials whose curve is longer than max_length"},
     {"trials/degenerate", Data::count, "", "1",
      "number of trials that end at a caustic or a focus"},
     {"trials/iterations", Data::count, "", "1", "Gauss-Newton steps of all trials"},
     {"trials/pairs", Data::count, "", "1", "pairs of points for which curves were searched"},
     {"trials/found", Data::count, "", "1", "pairs whose first trial found a curve"},
     {"trials/further", Data::count, "", "1",
      "further trials until the curve of the first trial was found again"},
     {"trials/roulette_ends", Data::count, "", "1", "searches terminated by Russian roulette"}}};

void write_trials(ResultFile& file, const ConnectionStatistics& statistics) {
  const ResultGroup root(file, trials_table);
  for (std::size_t i = 0; i < trial_outcomes; ++i)  // the first rows of the table are the outcomes
    root.put(trials_table.rows[i].path, statistics.outcomes[i]);
  root.put("trials/iterations", statistics.iterations);
}

void write_pairs(ResultFile& file, const ConnectionStatistics& statistics) {
  const ResultGroup root(file, trials_table);
  root.put("trials/pairs", statistics.pairs);
  root.put("trials/found", statistics.found);
  root.put("trials/further", statistics.further);
  root.put("trials/roulette_ends", statistics.roulette_terminations);
}

}  // namespace flatspeckle::grin

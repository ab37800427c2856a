#include "grin/connections/connection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

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
  const std::size_t bin = std::bit_width(std::max<std::uint64_t>(further_trials, 1)) - 1;
  ++refind_counts[std::min(bin, refind_counts.size() - 1)];
}

ConnectionStatistics& ConnectionStatistics::operator+=(const ConnectionStatistics& other) {
  const auto add = [](auto& sums, const auto& terms) {
    std::transform(sums.begin(), sums.end(), terms.begin(), sums.begin(), std::plus<>());
  };
  add(outcomes, other.outcomes);
  add(refind_counts, other.refind_counts);
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

}  // namespace flatspeckle::grin

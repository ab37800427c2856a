#include "grin/render/methods/render_pilot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace flatspeckle::grin {

namespace {

constexpr int fewest_pairs = 4, most_pairs = 256;
constexpr std::uint64_t enough_flights = 1 << 16;
constexpr int pilot_scatterings = 1 << 15;  // of a pilot's path, which need not end

struct Pilot {
  int pairs = 0;
  bool is_cut = false;  // some path may have been longer
  TransportCounts counts;
  JoinPromises promises;  ///< [pair][sensor]

  double flights_per_pair() const {
    return std::max(static_cast<double>(counts.flights) / pairs, 1.0);
  }
  /// Sum over the pairs, of one sensor.
  JoinPromise sum(std::size_t at, std::size_t sensors) const {
    JoinPromise all;
    for (std::size_t i = at; i < promises.size(); i += sensors) {
      all.joins += promises[i].joins;
      all.made += promises[i].made;
      all.brought += promises[i].brought;
      all.hits += promises[i].hits;
      all.beams += promises[i].beams;
    }
    return all;
  }
};

/// The same pairs each time, with the levels of joins that the transport has: up to so many, so
/// many at once.
Pilot pilot(Transport& transport, const PathKernel& kernel, const TimeBins& bins,
            int pairs = most_pairs, int at_once = 1) {
  constexpr auto no_batch = std::numeric_limits<std::uint64_t>::max();
  const int pixels = transport.pixels();
  std::vector<Complex> sums(static_cast<std::size_t>(pixels) * bins.sums());
  Film film(pixels, bins, sums);
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), no_batch);
  const int limit = transport.max_scatterings;
  transport.max_scatterings = std::min(limit, pilot_scatterings);
  Pilot found;
  for (; found.pairs < pairs; found.pairs += at_once) {
    if (found.pairs >= fewest_pairs && found.counts.flights >= enough_flights) break;
    const std::uint64_t before = found.counts.flights;
    kernel(at_once, random, film, found.counts, &found.promises);
    found.is_cut |= found.counts.flights - before >= pilot_scatterings;
  }
  transport.max_scatterings = limit;
  return found;
}

Pilot pilot_without_joins(Transport& transport, const PathKernel& kernel, const TimeBins& bins) {
  for (double& level : transport.join_levels) level = std::numeric_limits<double>::infinity();
  transport.beam_levels = transport.join_levels;
  return pilot(transport, kernel, bins);
}

/// Joins to beams that bring next to nothing beside others only cost time.
bool pay_joins_to_beams(Transport& transport, const PathKernel& kernel, const TimeBins& bins) {
  constexpr double next_to_nothing = 0.01;
  const std::size_t sensors = transport.sensors.size();
  for (double& level : transport.beam_levels) level = 0;
  const Pilot with = pilot(transport, kernel, bins, 64 * most_pairs);
  for (std::size_t at = 0; at < sensors; ++at) {
    const JoinPromise sum = with.sum(at, sensors);
    if (sum.beams > next_to_nothing * (sum.joins + sum.hits)) return true;
  }
  return false;
}

/// What joins to each sensor bring over what they promise, by some tens of them; never less than 1,
/// as few joins bring most.
std::vector<double> returns_of_joins(Transport& transport, const PathKernel& kernel,
                                     const TimeBins& bins, const Pilot& without) {
  constexpr double joins = 64, most = 1e6;
  const std::size_t sensors = transport.sensors.size();
  for (std::size_t at = 0; at < sensors; ++at)
    transport.join_levels[at] = without.sum(at, sensors).joins / joins;
  const Pilot with = pilot(transport, kernel, bins);
  std::vector<double> returns;
  for (std::size_t at = 0; at < sensors; ++at) {
    const JoinPromise sum = with.sum(at, sensors);
    const double brings = sum.brought / sum.made;
    returns.push_back(brings > 1 ? std::min(brings, most) : 1);
  }
  return returns;
}

double known_flights(const Pilot& pilot) {
  return pilot.is_cut ? std::numeric_limits<double>::infinity() : pilot.flights_per_pair();
}

/// Without the few that promise most: what is near an end is rare, and would decide alone. 0 to
/// rounding where all are the same: so is the level of joins then.
double trimmed_variance(std::vector<double> promises) {
  std::sort(promises.begin(), promises.end());
  promises.resize(promises.size() - std::max<std::size_t>(1, promises.size() / 64));
  const double n = static_cast<double>(promises.size());
  const double mean = std::accumulate(promises.begin(), promises.end(), 0.0) / n;
  const auto add_square = [&](double sum, double x) { return sum + (x - mean) * (x - mean); };
  return std::accumulate(promises.begin(), promises.end(), 0.0, add_square) / n;
}

}  // namespace

double flights_per_path(Transport& transport, const PathKernel& kernel, const TimeBins& bins) {
  constexpr int some = 64;
  return known_flights(pilot(transport, kernel, bins, some, some));
}

/// One vertex of a light path stands for all in a join: their mean number sets the share, and twice
/// that how many are kept for joins. With more, bidirectional meets rare long paths that change its
/// picture (white furnace of optical depth 200); with fewer, a pinhole in thick fog under a beam
/// gains little from joins. A pair costs F flights and varies by V. Joins of the promise S, which
/// bring r S, at a level L add r^2 L S to V and cost c S/L flights; variance times cost is least at
/// (r L)^2 = c V / F, both without joins.
double tune_joins(Transport& transport, const PathKernel& kernel, const TimeBins& bins,
                  double flights_per_join) {
  const Pilot first = pilot_without_joins(transport, kernel, bins);
  const double collisions = static_cast<double>(first.counts.light_collisions) / first.pairs;
  transport.strategies.joined_share = std::min(1.0, 1 / collisions);
  transport.strategies.kept = 1 - 1 / (2 + 2 * collisions);
  if (transport.strategies.joins_beams && !transport.strategies.short_light)
    transport.strategies.joins_beams = pay_joins_to_beams(transport, kernel, bins);
  const Pilot second = pilot_without_joins(transport, kernel, bins);
  const auto returns = returns_of_joins(transport, kernel, bins, second);
  const std::size_t sensors = transport.sensors.size();
  for (std::size_t at = 0; at < sensors; ++at) {
    std::vector<double> expected;
    for (std::size_t i = at; i < second.promises.size(); i += sensors)
      expected.push_back(returns[at] * second.promises[i].joins + second.promises[i].hits);
    transport.join_levels[at] =
        std::sqrt(flights_per_join * trimmed_variance(expected) / second.flights_per_pair()) /
        returns[at];
    transport.beam_levels[at] = transport.join_levels[at] / 10;  // they bring very unequal amounts
  }
  return known_flights(second);
}

}  // namespace flatspeckle::grin

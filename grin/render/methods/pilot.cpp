#include "grin/render/methods/pilot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace flatspeckle::grin {

namespace {

constexpr int fewest_pairs = 4, most_pairs = 256;
constexpr std::uint64_t enough_flights = 1 << 16;
// largest number of scatterings of a path in a pilot run
constexpr int pilot_scatterings = 1 << 15;

struct Pilot {
  int pairs = 0;
  bool is_cut = false;  // whether some path may have been cut off by pilot_scatterings
  TransportCounts counts;
  ExpectedConnections expected_connections;  ///< [pair][sensor]

  double flights_per_pair() const {
    return std::max(static_cast<double>(counts.flights) / pairs, 1.0);
  }
  /// Returns the sum over the pairs for sensor number `at`.
  ExpectedConnection sum(std::size_t at, std::size_t sensors) const {
    ExpectedConnection all;
    for (std::size_t i = at; i < expected_connections.size(); i += sensors) {
      all.considered += expected_connections[i].considered;
      all.made += expected_connections[i].made;
      all.contributed += expected_connections[i].contributed;
      all.square += expected_connections[i].square;
      all.hits += expected_connections[i].hits;
      all.beams += expected_connections[i].beams;
    }
    return all;
  }
};

/// Runs a deterministic pilot of up to `pairs` pairs of light path and sensor paths, at_once in
/// each call of the kernel, with the current roulette thresholds of the transport.
Pilot pilot(Transport& transport, const PathKernel& kernel, const TimeBins& bins,
            int pairs = most_pairs, int at_once = 1) {
  constexpr auto no_batch = std::numeric_limits<std::uint64_t>::max();
  const int pixels = transport.pixels();
  std::vector<Complex> sums(static_cast<std::size_t>(pixels) * bins.sums());
  Film film(pixels, bins, sums);
  const int limit = transport.max_scatterings;
  transport.max_scatterings = std::min(limit, pilot_scatterings);
  const auto may_be_cut = [&](const Film& of) {
    return limit > pilot_scatterings && of.energy.of(Termination::cut) > 0;
  };
  Pilot found;
  for (; found.pairs < pairs; found.pairs += at_once) {
    if (found.pairs >= fewest_pairs && found.counts.flights >= enough_flights) break;
    const std::uint64_t before = found.counts.flights;
    RandomStream random(0, static_cast<std::uint64_t>(Stream::render),
                        no_batch - static_cast<std::uint64_t>(found.pairs));
    kernel(at_once, random, film, found.counts, &found.expected_connections);
    const std::uint64_t flights = found.counts.flights - before;
    found.is_cut |= flights >= pilot_scatterings && (at_once == 1 || may_be_cut(film));
  }
  transport.max_scatterings = limit;
  return found;
}

Pilot pilot_without_connections(Transport& transport, const PathKernel& kernel,
                                const TimeBins& bins) {
  for (double& level : transport.connection_levels) level = std::numeric_limits<double>::infinity();
  transport.beam_levels = transport.connection_levels;
  return pilot(transport, kernel, bins);
}

/// Whether connections to beams contribute enough to justify their cost.
bool pay_connections_to_beams(Transport& transport, const PathKernel& kernel,
                              const TimeBins& bins) {
  constexpr double next_to_nothing = 0.01;
  const std::size_t sensors = transport.sensors.size();
  for (double& level : transport.beam_levels) level = 0;
  const Pilot with = pilot(transport, kernel, bins, 64 * most_pairs);
  for (std::size_t at = 0; at < sensors; ++at) {
    const ExpectedConnection sum = with.sum(at, sensors);
    if (sum.beams > next_to_nothing * (sum.considered + sum.hits)) return true;
  }
  return false;
}

/// Ratio of actual to expected contribution, of connections that undergo Russian roulette. Both
/// values are at least 1: smaller ones are not reliable, since few connections contribute most.
struct Return {
  double mean = 1, rms = 1;
};

/// Returns the ratios for the connections to each sensor, with the current thresholds.
std::vector<Return> returns_of_connections(Transport& transport, const PathKernel& kernel,
                                           const TimeBins& bins) {
  const std::size_t sensors = transport.sensors.size();
  const Pilot with = pilot(transport, kernel, bins);
  const auto bounded = [](double ratio) { return ratio > 1 ? std::min(ratio, 1e6) : 1; };
  std::vector<Return> returns;
  for (std::size_t at = 0; at < sensors; ++at) {
    const ExpectedConnection sum = with.sum(at, sensors);
    // a connection that is made contributes its ratio times the threshold
    const double square = sum.square / (sum.made * transport.connection_levels[at]);
    returns.push_back({bounded(sum.contributed / sum.made), bounded(std::sqrt(square))});
  }
  return returns;
}

double known_flights(const Pilot& pilot) {
  return pilot.is_cut ? std::numeric_limits<double>::infinity() : pilot.flights_per_pair();
}

/// Variance without the largest 1/64 of the values: contributions near an endpoint are rare and
/// would dominate. If all values are equal, it is 0 to rounding, and so is the roulette threshold.
double trimmed_variance(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.resize(values.size() - std::max<std::size_t>(1, values.size() / 64));
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  const auto add_square = [&](double sum, double x) { return sum + (x - mean) * (x - mean); };
  return std::accumulate(values.begin(), values.end(), 0.0, add_square) / n;
}

}  // namespace

double flights_per_path(Transport& transport, const PathKernel& kernel, const TimeBins& bins) {
  constexpr int some = 64;
  return known_flights(pilot(transport, kernel, bins, some, some));
}

/// In a connection one vertex of a light path represents all its vertices, so that
/// connected_fraction is 1 / (mean number of collisions). About twice as many vertices as the mean
/// number of collisions are kept. If more were kept, bidirectional tracing would have rare long
/// paths of high weight (white furnace of optical depth 200). If fewer were kept, a pinhole in
/// thick fog under a beam would gain little from connections. The thresholds minimise variance
/// times cost: without connections a pair costs F flights and has variance V. Connections of
/// expected contribution S and actual contribution r S, at a threshold L and a cost of c flights
/// each, add r^2 L S to the variance and c S/L flights to the cost. The product is least at
/// (r L)^2 = c V / F. Along curved rays r varies and is higher for connections of low S: its RMS
/// value is measured for those below L.
double tune_connections(Transport& transport, const PathKernel& kernel, const TimeBins& bins,
                        double flights_per_connection, bool curved) {
  const Pilot first = pilot_without_connections(transport, kernel, bins);
  const double collisions = static_cast<double>(first.counts.light_collisions) / first.pairs;
  transport.strategies.connected_fraction = std::min(1.0, 1 / collisions);
  transport.strategies.kept = 1 - 1 / (2 + 2 * collisions);
  if (transport.strategies.connects_beams && !transport.strategies.short_light)
    transport.strategies.connects_beams = pay_connections_to_beams(transport, kernel, bins);
  const Pilot second = pilot_without_connections(transport, kernel, bins);
  const std::size_t sensors = transport.sensors.size();
  constexpr double some = 64;  // connections made
  for (std::size_t at = 0; at < sensors; ++at)
    transport.connection_levels[at] = second.sum(at, sensors).considered / some;
  const auto returns = returns_of_connections(transport, kernel, bins);
  for (std::size_t at = 0; at < sensors; ++at) {
    std::vector<double> expected;
    for (std::size_t i = at; i < second.expected_connections.size(); i += sensors)
      expected.push_back(returns[at].mean * second.expected_connections[i].considered +
                         second.expected_connections[i].hits);
    transport.connection_levels[at] =
        std::sqrt(flights_per_connection * trimmed_variance(expected) / second.flights_per_pair()) /
        returns[at].mean;
  }
  if (curved) {
    const auto below = returns_of_connections(transport, kernel, bins);
    for (std::size_t at = 0; at < sensors; ++at)
      transport.connection_levels[at] *= std::min(returns[at].mean / below[at].rms, 1.0);
  }
  for (std::size_t at = 0; at < sensors; ++at)
    // contributions of connections to beams vary strongly
    transport.beam_levels[at] = transport.connection_levels[at] / 10;
  return known_flights(second);
}

}  // namespace flatspeckle::grin

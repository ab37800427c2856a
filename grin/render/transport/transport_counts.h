#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/run/interrupt.h"
#include "grin/rays/connections/connection.h"
#include "grin/render/transport/film.h"

namespace flatspeckle::grin {

/// Expected and actual contributions to a sensor from one pair of light path and sensor path. A
/// contribution that undergoes Russian roulette is divided by the probability of the roulette.
struct ExpectedConnection {
  /// Expected contribution of all connections, whether they are made or not.
  double considered = 0;
  /// Expected and actual contribution of the connections that are made after a roulette.
  double made = 0, contributed = 0;
  double square = 0;  ///< sum of the squares of these actual contributions
  double hits = 0;   ///< contribution of paths that hit an endpoint
  double beams = 0;  ///< contribution of connections to beams
};

/// Indexed [pair of light path and sensor paths][sensor].
using ExpectedConnections = std::vector<ExpectedConnection>;

/// Counts of the operations that determine the cost of paths.
struct TransportCounts {
  std::uint64_t flights = 0, lost_flights = 0;
  std::uint64_t light_collisions = 0;  ///< collisions of light paths
  /// Number of connections whose expected contribution was computed, and of those for which a curve
  /// was searched for (Space).
  std::uint64_t connections_weighed = 0, connections_made = 0;
  std::uint64_t lost_values = 0;  ///< contributions left out because they were not finite
  ConnectionStatistics connections = {};

  /// Counts a flight that has ended. Every 256 flights it throws Interrupted if a signal has
  /// arrived.
  void add_flight(bool is_lost) {
    constexpr std::uint64_t between_checks = 256;
    if (++flights % between_checks == 0) stop_if_interrupted();
    lost_flights += is_lost;
  }

 private:
  template <class Counts>
  static auto reported(Counts& counts) {
    auto& curves = counts.connections;
    std::array all{&counts.flights,     &counts.lost_flights, &counts.connections_made,
                   &counts.lost_values, &curves.iterations,   &curves.pairs,
                   &curves.found,       &curves.further,      &curves.roulette_terminations,
                   &curves.outcomes[0], &curves.outcomes[1],  &curves.outcomes[2],
                   &curves.outcomes[3], &curves.outcomes[4],  &curves.outcomes[5]};
    static_assert(all.size() == size);
    return all;
  }

 public:
  /// Number of counters that a result reports; they are summed over batches.
  static constexpr std::size_t size = 9 + trial_outcomes;
  void add_to(std::span<Complex> sums) const {
    const auto all = reported(*this);
    for (std::size_t i = 0; i < size; ++i) sums[i] += static_cast<double>(*all[i]);
  }
  static TransportCounts of(std::span<const Complex> sums) {
    TransportCounts counts;
    const auto all = reported(counts);
    for (std::size_t i = 0; i < size; ++i) *all[i] = static_cast<std::uint64_t>(sums[i].real());
    return counts;
  }
};

/// Adds a value to a pixel of a film, unless the pixel is -1 (none). A value that is not finite is
/// counted instead. transfer: momentum transfer of the path, if it is tallied.
inline void deposit(Film& film, TransportCounts& counts, int pixel, double value,
                    double optical_path, const MomentumTransfer& transfer = no_transfer) {
  if (pixel < 0 || value == 0) return;
  if (!std::isfinite(value)) {
    ++counts.lost_values;
    return;
  }
  film.add(pixel, value, optical_path);
  if (film.has_decay()) film.add_decay(pixel, value, optical_path, transfer);
}
/// Adds a value to sum `number` of a pixel's derivatives by parameters of the field. A value that
/// is not finite is counted instead.
inline void deposit_by_field(Film& film, TransportCounts& counts, int pixel, int number,
                             double value) {
  if (std::isfinite(value))
    film.add_by_field(pixel, number, value);
  else
    ++counts.lost_values;
}

}  // namespace flatspeckle::grin

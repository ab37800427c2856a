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

/// What joins promise to a sensor, and what those that are made bring, each over its chance.
struct JoinPromise {
  double joins = 0;  ///< made or not
  double made = 0, brought = 0;
  double hits = 0;   ///< what came without a join
  double beams = 0;  ///< what joins to beams brought
};

/// [pair of paths][sensor].
using JoinPromises = std::vector<JoinPromise>;

/// What light paths cost.
struct TransportCounts {
  std::uint64_t flights = 0, lost_flights = 0;
  std::uint64_t light_collisions = 0;          ///< of paths from lights
  std::uint64_t joins_weighed = 0, joins = 0;  ///< considered; asked of space
  std::uint64_t lost_values = 0;               ///< not finite; left out
  ConnectionStatistics connections = {};

  /// Of a flight that has ended. Throws Interrupted, now and then, once a signal has come.
  void add_flight(bool is_lost) {
    constexpr std::uint64_t between_looks = 256;
    if (++flights % between_looks == 0) stop_if_interrupted();
    lost_flights += is_lost;
  }

 private:
  template <class Counts>
  static auto told(Counts& counts) {
    auto& curves = counts.connections;
    std::array all{&counts.flights,     &counts.lost_flights, &counts.joins,
                   &counts.lost_values, &curves.iterations,   &curves.pairs,
                   &curves.found,       &curves.refind,       &curves.roulette_ends,
                   &curves.outcomes[0], &curves.outcomes[1],  &curves.outcomes[2],
                   &curves.outcomes[3], &curves.outcomes[4],  &curves.outcomes[5]};
    static_assert(all.size() == size);
    return all;
  }

 public:
  /// Of those that a result tells; they add up over batches, as sums do.
  static constexpr std::size_t size = 9 + trial_outcomes;
  void add_to(std::span<Complex> sums) const {
    const auto all = told(*this);
    for (std::size_t i = 0; i < size; ++i) sums[i] += static_cast<double>(*all[i]);
  }
  static TransportCounts of(std::span<const Complex> sums) {
    TransportCounts counts;
    const auto all = told(counts);
    for (std::size_t i = 0; i < size; ++i) *all[i] = static_cast<std::uint64_t>(sums[i].real());
    return counts;
  }
};

/// Adds to a pixel of a film, if there is one (-1: none) and the value is finite.
inline void deposit(Film& film, TransportCounts& counts, int pixel, double value,
                    double optical_path) {
  if (pixel < 0 || value == 0) return;
  if (!std::isfinite(value)) {
    ++counts.lost_values;
    return;
  }
  film.add(pixel, value, optical_path);
}
/// Likewise to a sum of derivatives by the field.
inline void deposit_by_field(Film& film, TransportCounts& counts, int pixel, int number,
                             double value) {
  if (std::isfinite(value))
    film.add_by_field(pixel, number, value);
  else
    ++counts.lost_values;
}

}  // namespace flatspeckle::grin

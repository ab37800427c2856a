#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "grin/render/stage/flight.h"
#include "grin/render/stage/part_medium.h"

namespace flatspeckle::grin {

/// A stretch of a flight within one part.
struct FlightLeg {
  PathPoint start;
  Vec3 direction;  ///< there, unit
  double length;
  double weight;  ///< of the flight, there
};
using FlightLog = std::vector<FlightLeg>;

/// Calls use(x, arc length that x stands for times the light left there) for points of a leg that
/// are at most `apart` from each other, evenly spaced from a random start: sums over them are
/// integrals on average. x_at(s) is asked for increasing s.
template <class At, class Use>
void for_points(const FlightLeg& leg, const PartMedium& medium, double apart, RandomStream& random,
                At x_at, const Use& use) {
  const double count = std::max(1.0, std::ceil(leg.length / apart));
  const double spacing = leg.length / count, offset = random.uniform();
  const bool absorbs = !medium.scatters() && medium.mu_t() > 0;
  const auto collide = [&] { return sample_free_flight(medium.majorant(), random.uniform()); };
  double left = leg.weight;
  double tentative = absorbs && medium.grid() ? collide() : std::numeric_limits<double>::infinity();
  for (double i = 0; i < count; ++i) {
    const double s = (i + offset) * spacing;
    for (; tentative < s; tentative += collide()) left *= medium.lacking(x_at(tentative));
    const bool is_even = absorbs && !medium.grid();
    use(x_at(s), spacing * (is_even ? left * transmittance(medium.mu_t(), s) : left));
  }
}

}  // namespace flatspeckle::grin

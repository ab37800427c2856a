#include "mc/space/space_slope.h"

#include <algorithm>
#include <utility>

#include "mc/jobs/bulk_parameter.h"
#include "mc/transport/bulk_slope.h"

namespace flatspeckle::mc {

SpaceSlope::SpaceSlope(const SpaceLaw& law)
    : law_(law), moments_{law.moments(), std::vector<double>(law.moments().size())} {}

/// The moments are g^l.
SpaceSlope SpaceSlope::by_g(const SpaceLaw& law, double g) {
  SpaceSlope slope(law);
  slope.by_g_ = true;
  slope.g_ = g;
  slope.moments_.slope = power_slopes(g, law.moments().size() + 1);
  return slope;
}

SpaceSlope::SpaceSlope(const SpaceLaw& law, std::vector<Neighbour> neighbours) : SpaceSlope(law) {
  neighbours_ = std::move(neighbours);
  auto& moments = moments_.slope;
  for (const auto& [weight, near] : neighbours_) {
    moments.resize(std::max(moments.size(), near.moments().size()));
    for (std::size_t l = 0; l < near.moments().size(); ++l)
      moments[l] += weight * near.moments()[l];
  }
}

Dual<double> SpaceSlope::pair(double first, double second) const {
  Dual<double> pair{law_.pair(first, second), 0};
  for (const auto& [weight, near] : neighbours_) pair.slope += weight * near.pair(first, second);
  if (!by_g_) return pair;
  const auto by_g = [this](double cosine) { return henyey_greenstein_slope(g_, 1 - cosine, 3); };
  pair.slope = (by_g(first) + by_g(second)) / 2 * pair.value;
  return pair;
}

}  // namespace flatspeckle::mc

#include "mc/space/space_slope.h"

#include "mc/estimators/bulk_parameter.h"
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

Dual<double> SpaceSlope::pair(double first, double second) const {
  const double pair = law_.pair(first, second);
  if (!by_g_) return {pair, 0};
  const auto by_g = [this](double cosine) { return henyey_greenstein_slope(g_, 1 - cosine, 3); };
  return {pair, (by_g(first) + by_g(second)) / 2 * pair};
}

}  // namespace flatspeckle::mc

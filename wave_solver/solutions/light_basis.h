#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"
#include "flatland/request/light.h"

namespace flatspeckle::wave {

/// A few of many plane waves, of which the others are combinations within a circle: never more than
/// about 2 k R + 50, however many lights there are, and fewer where they come from a narrow range.
struct LightBasis {
  std::vector<double> angles;
  std::vector<Complex> weights;  ///< [light][basis]; empty where every light stands for itself
  std::vector<Vec2> sources;     ///< point sources, which have no plane waves beside them

  std::size_t size() const { return angles.size() + sources.size(); }
  /// Of the lights that it stands for.
  std::size_t count() const { return weights.empty() ? size() : weights.size() / size(); }
};

struct Circle {
  Vec2 centre;
  double radius = 0;
};

/// Around the rims of all disks.
Circle enclosing_circle(const Placement& placement);

/// Column-pivoted QR of the waves' Bessel coefficients on the circle (J_n decays beyond k R); what
/// it leaves out is below tolerance of a unit wave. Falls back to all lights where that saves
/// little.
LightBasis light_basis(std::span<const double> angles, double k, const Circle& circle,
                       double tolerance);
/// Of any lights: a Gaussian beam is the superposition of plane waves that has the beam's field
/// across its focus, but for what does not propagate. Throws InputError for point sources mixed
/// with others.
LightBasis basis_of(const Lights& lights, double k, const Circle& circle, double tolerance);

}  // namespace flatspeckle::wave

#pragma once

#include <memory>
#include <string>

#include "core/numbers/random.h"
#include "grin/fields/vec3.h"
#include "grin/media/density_grid.h"
#include "grin/media/phase_function.h"

namespace flatspeckle::grin {

/// The phase function of a medium in space, per steradian.
struct SpacePhaseFunction {
  enum class Kind { isotropic, henyey_greenstein, rayleigh };
  Kind kind = Kind::isotropic;
  double g = 0;  ///< of henyey_greenstein, |g| < 1

  double density(double cosine) const;
  /// Where light that goes along `direction`, a unit vector, goes next.
  Vec3 sample(const Vec3& direction, RandomStream& random) const;
};

/// What scatters and absorbs, 1/length.
struct ScatteringMedium {
  double mu_s = 0, mu_a = 0;  ///< where the relative density is 1
  SpacePhaseFunction phase = {};
  std::shared_ptr<const DensityGrid> density = {};  ///< relative; nothing: 1 everywhere

  double mu_t() const { return mu_s + mu_a; }
  double albedo() const { return mu_s > 0 ? mu_s / mu_t() : 0; }
};

/// Throws InputError for coefficients that are negative or not finite, or |g| >= 1; the keys named
/// begin with `prefix`.
void check(const ScatteringMedium& medium, const std::string& prefix);

}  // namespace flatspeckle::grin

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/keys/keys.h"
#include "core/numbers/random.h"
#include "grin/geometry/vec3.h"
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

/// A medium as keys have it; without mu_s and mu_a there is none.
struct MediumValues {
  std::optional<double> mu_s = {}, mu_a = {};
  std::string phase = "isotropic", density = {};
  double g = 0;
};

/// prefix: of the keys, "" or "body_".
void add_keys(Keys& keys, MediumValues& values, const std::string& prefix);

/// Throws InputError.
ScatteringMedium make_medium(const Keys& keys, const MediumValues& values);

}  // namespace flatspeckle::grin

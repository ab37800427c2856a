#pragma once

#include <memory>
#include <optional>
#include <string>

#include "grin/media/scattering/density_grid.h"
#include "grin/media/scattering/space_phases.h"

namespace flatspeckle::grin {

/// What scatters and absorbs, 1/length.
struct ScatteringMedium {
  double mu_s = 0, mu_a = 0;  ///< where the relative density is 1
  SpacePhaseFunction phase = {};
  std::shared_ptr<const DensityGrid> density = {};  ///< relative; nothing: 1 everywhere

  double mu_t() const { return mu_s + mu_a; }
  double albedo() const { return mu_s > 0 ? mu_s / mu_t() : 0; }
  double absorption(const Vec3& x) const { return density ? mu_a * (*density)(x) : mu_a; }
};

/// A medium as keys have it; without mu_s and mu_a there is none.
struct MediumValues {
  std::optional<double> mu_s = {}, mu_a = {};
  std::string phase = IsotropicPhase::word, density = {};
  SpacePhaseKinds kinds{};

  template <class Kind>
  Kind& of() {
    return std::get<Kind>(kinds);
  }
};

/// prefix: of the keys, "" or "body_".
void add_keys(Keys& keys, MediumValues& values, const std::string& prefix);

/// Throws InputError.
ScatteringMedium make_medium(const Keys& keys, const MediumValues& values);

}  // namespace flatspeckle::grin

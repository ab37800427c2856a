#pragma once

#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mc/paths/bent/graded_medium.h"
#include "mc/paths/endpoint_factors/endpoint_factors.h"
#include "mc/paths/endpoint_factors/varying_scattering.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Scattering (scattering.h) in a medium whose refractive index varies, so that flights between
/// scatterers are curved.
class GradedScattering {
 public:
  GradedScattering(AnyScattering form, std::shared_ptr<const GradedMedium> medium)
      : form_(std::move(form)), medium_(std::move(medium)) {}

  const AnyScattering& form() const { return form_; }
  const GradedMedium& medium() const { return *medium_; }

 private:
  AnyScattering form_;
  std::shared_ptr<const GradedMedium> medium_;
};

inline const AnyScattering& local(const GradedScattering& scattering, Vec) {
  return scattering.form();
}

template <typename Scattering>
constexpr bool bends = false;
template <>
inline constexpr bool bends<GradedScattering> = true;

/// Returns the amplitudes of spheres at equal steps of the scattering angle from 0 to pi; for mie,
/// the square root of the phase function.
std::vector<Complex> sphere_amplitudes(const Scene& scene);

/// Calls f with the scattering object of a homogeneous medium, of the type that `phase` selects.
/// Throws std::logic_error for varying and graded media.
template <typename F>
void with_scattering(const Scene& scene, Plan::Phase phase, F f) {
  switch (phase) {
    case Plan::Phase::isotropic:
      return f(IsotropicScattering{});
    case Plan::Phase::henyey_greenstein:
      return f(HenyeyGreensteinScattering{{scene.scatterer.g}});
    case Plan::Phase::tabulated:
      return f(TabulatedScattering(scene.medium, scene.k));
    case Plan::Phase::isotropic_in_space:
      return f(IsotropicInSpace{});
    case Plan::Phase::space:
      return f(SpaceScattering(scene.medium.space_phase));
    case Plan::Phase::henyey_greenstein_in_space:
      return f(HenyeyGreensteinInSpace{{scene.scatterer.g}});
    case Plan::Phase::tabulated_in_space:
      return f(TabulatedSpaceScattering(sphere_amplitudes(scene)));
    case Plan::Phase::varying:
    case Plan::Phase::graded:
      break;
  }
  throw std::logic_error("with_scattering: the medium is not homogeneous");
}

/// Returns the scattering of a medium whose material varies with position. Each material has its
/// own form of scattering.
VaryingScattering varying_scattering(const Scene& scene);

/// Returns the scattering in a medium whose refractive index varies.
GradedScattering graded_scattering(const Scene& scene);

}  // namespace flatspeckle::mc

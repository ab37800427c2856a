#pragma once

#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mc/paths/bent/graded_scattering.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Calls f with the scattering of a scene of the plane in one of its forms. Throws std::logic_error
/// for any other scene.
template <typename F>
void with_scattering(const Scene& scene, Plan::Phase phase, F f) {
  if (scene.medium.dimension != 2)
    throw std::logic_error("with_scattering: a scene in space has no form in the plane");
  switch (phase) {
    case Plan::Phase::isotropic:
      return f(IsotropicScattering{});
    case Plan::Phase::henyey_greenstein:
      return f(HenyeyGreensteinScattering{{scene.scatterer.g}});
    case Plan::Phase::tabulated:
      return f(TabulatedScattering(scene.medium, scene.k));
    case Plan::Phase::space:
    case Plan::Phase::varying:
    case Plan::Phase::graded:
      break;
  }
  throw std::logic_error("with_scattering: not the phase function of a scatterer in the plane");
}

/// Of a medium that varies: of each material in its form.
VaryingScattering varying_scattering(const Scene& scene);

/// Of a medium whose index varies.
GradedScattering graded_scattering(const Scene& scene);

}  // namespace flatspeckle::mc

#pragma once

#include <type_traits>

#include "flatland/scene.h"
#include "mc/path_walk.h"
#include "mc/plan.h"
#include "mc/scattering.h"

namespace flatspeckle::mc {

/// Calls f with std::true_type or std::false_type.
template <typename F>
void with_flag(bool flag, F f) {
  if (flag)
    f(std::true_type{});
  else
    f(std::false_type{});
}

/// Calls f with the scattering that a plan picks.
template <typename F>
void with_scattering(const Scene& scene, const Plan& plan, F f) {
  switch (plan.phase) {
    case Plan::Phase::isotropic:
      return f(IsotropicScattering{});
    case Plan::Phase::henyey_greenstein:
      return f(HenyeyGreensteinScattering{{scene.scatterer.g}});
    case Plan::Phase::tabulated:
      return f(TabulatedScattering(scene.medium, scene.k));
  }
}

/// What all batches of walks share.
template <typename Scattering, bool reversed, bool weighted, typename Tally = NoTally>
struct WalkSetup {
  WalkSetup(const Scene& its_scene, const Plan& its_plan, const Scattering& its_scattering,
            Tally tally = {})
      : scene(its_scene),
        plan(its_plan),
        scattering(its_scattering),
        walk(scene, plan, scattering, tally) {}
  WalkSetup(const WalkSetup&) = delete;

  const Scene scene;
  const Plan plan;
  const Scattering scattering;
  const PathWalk<Scattering, reversed, weighted, Tally> walk;
};

}  // namespace flatspeckle::mc

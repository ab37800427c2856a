#pragma once

#include <cassert>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <type_traits>

#include "core/error.h"
#include "flatland/scene/index_fields.h"
#include "flatland/scene/scene.h"
#include "mc/ends/space_scattering.h"
#include "mc/graded/graded_ends.h"
#include "mc/graded/graded_scattering.h"
#include "mc/walk/path_walk.h"
#include "mc/walk/plan.h"

namespace flatspeckle::mc {

/// Adds batch `number` to zeroed sums.
using SummedBatches = std::function<void(std::uint64_t number, std::span<Complex> sums)>;

/// Calls f with std::true_type or std::false_type.
template <typename F>
void with_flag(bool flag, F f) {
  if (flag)
    f(std::true_type{});
  else
    f(std::false_type{});
}

/// Calls f with the scattering of a scene of the plane in one of its forms.
template <typename F>
void with_scattering(const Scene& scene, Plan::Phase phase, F f) {
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
      assert(false);
  }
}

/// Of a medium that varies: of each material in its form.
inline VaryingScattering varying_scattering(const Scene& scene) {
  std::vector<AnyScattering> forms;
  for (const Material& material : scene.profile->materials()) {
    Scene own = scene;
    own.scatterer = material.scatterer;
    own.medium = material.medium;
    with_scattering(own, phase_of(own.scatterer),
                    [&](const auto& scattering) { forms.emplace_back(scattering); });
  }
  return {*scene.profile, std::move(forms)};
}

/// Of a medium whose index varies.
inline GradedScattering graded_scattering(const Scene& scene) {
  std::vector<GradedScattering> made;
  const auto medium = graded_medium(scene);
  check_graded_ends(scene, *medium);
  with_scattering(scene, phase_of(scene.scatterer), [&](const auto& scattering) {
    made.emplace_back(AnyScattering(scattering), medium);
  });
  return made.front();
}

/// The same of any scene.
template <typename F>
void with_any_scattering(const Scene& scene, Plan::Phase phase, F f) {
  if (phase == Plan::Phase::varying) return f(varying_scattering(scene));
  if (phase == Plan::Phase::graded) return f(graded_scattering(scene));
  if (phase == Plan::Phase::space) return f(SpaceScattering(scene.medium.space_phase));
  with_scattering(scene, phase, f);
}

/// What all batches of walks share.
template <typename Kind, typename Scattering, bool weighted, bool reversed, bool phases>
class Walks {
 public:
  Walks(const Kind& kind, const Scene& scene, const Plan& plan, const Scattering& scattering)
      : kind_(kind),
        scene_(scene),
        plan_(plan),
        scattering_(scattering),
        walk_(scene_, plan_, scattering_, kind_.tally(scene_)) {}
  Walks(const Walks&) = delete;

  void batch(std::uint64_t seed, std::uint64_t number, typename Kind::Sums sums) const {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), number);
    auto scorer = kind_.template scorer<reversed, phases>(scene_, scattering_, sums);
    auto own = walk_;
    own.begin(random);
    for (std::uint64_t path = 0; path < plan_.paths_per_batch; ++path) own.walk(random, scorer);
  }

 private:
  using Tally = decltype(std::declval<const Kind&>().tally(std::declval<const Scene&>()));

  const Kind kind_;
  const Scene scene_;
  const Plan plan_;
  const Scattering scattering_;
  const PathWalk<Scattering, reversed, weighted, Tally> walk_;
};

/// Numbered batches of plan.paths_per_batch walks, each handed to a scorer of an estimator's kind
/// (path_walk.h). A kind is a type with
///   Sums                            what a batch adds to
///   tally(scene)                    what every path starts with
///   scorer<reversed, phases>(scene, scattering, sums)
/// and only_varying, if it is of media that vary alone, and bent, if it knows curved flights.
template <typename Kind>
auto walks(const Kind& kind, const Scene& scene, const Plan& plan, std::uint64_t seed) {
  using Sums = typename Kind::Sums;
  require_walks(scene, plan.weighted);
  std::function<void(std::uint64_t number, Sums)> batches = [](std::uint64_t, Sums) {};
  if (scene.medium.mu_s == 0) return batches;
  const auto choose = [&]<typename Scattering>(const Scattering& scattering, auto weighted,
                                               auto reversed, auto phases) {
    const auto shared = std::make_shared<const Walks<Kind, Scattering, weighted, reversed, phases>>(
        kind, scene, plan, scattering);
    batches = [=](std::uint64_t number, Sums sums) { shared->batch(seed, number, sums); };
  };
  with_any_scattering(scene, plan.phase, [&]<typename Scattering>(const Scattering& scattering) {
    constexpr bool fits = bends<Scattering> ? requires {
      Kind::bent;
    }
                                            : varies<Scattering> || !requires {
                                              Kind::only_varying;
                                            };
                                            if constexpr (!fits)
                                              refuse_graded(
                                                  scene,
                                                  "this; take covariances, fields or validate");
                                            else
                                              with_flag(plan.weighted, [&](auto weighted) {
                                                if (plan.reversed)
                                                  return choose(scattering, weighted,
                                                                std::true_type{}, std::true_type{});
                                                with_flag(plan.phases, [&](auto phases) {
                                                  choose(scattering, weighted, std::false_type{},
                                                         phases);
                                                });
                                              });
  });
  return batches;
}

}  // namespace flatspeckle::mc

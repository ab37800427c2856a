#pragma once

#include <tuple>
#include <variant>

#include "grin/media/geometry/vec3.h"
#include "grin/media/scattering/hg_phase.h"
#include "grin/media/scattering/isotropic_phase.h"
#include "grin/media/scattering/mie_phase.h"
#include "grin/media/scattering/rayleigh_phase.h"
#include "grin/media/scattering/start_directions.h"
#include "grin/media/scattering/table_phase.h"
#include "grin/media/scattering/two_term_phase.h"

namespace flatspeckle::grin {

/// All phase functions in space (explained in space_phase.h). To add one, extend only this list.
using SpacePhaseKinds = std::tuple<IsotropicPhase, HgPhase, RayleighPhase, TwoTermPhaseValues,
                                   TablePhaseValues, MiePhaseValues>;

template <class Kinds>
struct PhasesOf;
template <class... Kind>
struct PhasesOf<std::tuple<Kind...>> {
  using Any = std::variant<decltype(make_phase(std::declval<const Keys&>(), Kind()))...>;
};

/// The phase function of a medium in space, per steradian.
struct SpacePhaseFunction {
  PhasesOf<SpacePhaseKinds>::Any which = {};

  double density(double cosine) const {
    return std::visit([&](const auto& phase) { return phase.density(cosine); }, which);
  }
  double one_minus_cosine(RandomStream& random) const {
    return std::visit([&](const auto& phase) { return phase.one_minus_cosine(random); }, which);
  }
  /// Samples the direction after scattering of light along `direction`, a unit vector.
  Vec3 sample(const Vec3& direction, RandomStream& random) const {
    return random_turn(direction, one_minus_cosine(random), random);
  }
  double mean_cosine() const {
    return std::visit([](const auto& phase) { return phase.mean_cosine(); }, which);
  }
};

}  // namespace flatspeckle::grin

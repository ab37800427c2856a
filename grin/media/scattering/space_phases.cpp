#include "grin/media/scattering/space_phases.h"

#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::grin {

double SpacePhaseFunction::density(double cosine) const {
  return std::visit([&](const auto& phase) { return phase.density(cosine); }, which);
}

Vec3 SpacePhaseFunction::sample(const Vec3& direction, RandomStream& random) const {
  return random_turn(direction, one_minus_cosine(random), random);
}

double SpacePhaseFunction::mean_cosine() const {
  return std::visit([](const auto& phase) { return phase.mean_cosine(); }, which);
}

}  // namespace flatspeckle::grin

#include "grin/media/space_phases.h"

#include "grin/media/start_directions.h"

namespace flatspeckle::grin {

double SpacePhaseFunction::density(double cosine) const {
  return std::visit([&](const auto& phase) { return phase.density(cosine); }, which);
}

Vec3 SpacePhaseFunction::sample(const Vec3& direction, RandomStream& random) const {
  const auto turn = [&](const auto& phase) { return phase.one_minus_cosine(random); };
  return random_turn(direction, std::visit(turn, which), random);
}

double SpacePhaseFunction::mean_cosine() const {
  return std::visit([](const auto& phase) { return phase.mean_cosine(); }, which);
}

}  // namespace flatspeckle::grin

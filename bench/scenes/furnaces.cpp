#include "bench/scenes/furnaces.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace flatspeckle::bench {

using namespace grin;

Surface unit_box() {
  return Box{Vec3::Constant(-1), Vec3::Constant(1)};
}

Light environment() {
  return FaceLight{Vec3::Zero(), std::numeric_limits<double>::infinity()};
}

AreaDetector whole_face() {
  return {Vec3::UnitZ(), Vec3::UnitY(), 2, 2, {1, 1}, right_angle};
}

RenderScene scene_in(AnyIndexField field, Stage stage, Light light, Sensor sensor) {
  return {std::move(field),   0.05, 60, false, std::move(stage), {std::move(light)},
          {std::move(sensor)}};
}

double mean_square_index(const RenderScene& scene) {
  const int nodes = 100, phases = 32;
  if (!scene.stage.bodies.empty()) return std::pow(1 + scene.stage.excess_around, 2);
  const auto mean_of = [&](const auto& field) {
    double sum = 0;
    for (int i = 0; i < nodes; ++i)
      for (int j = 0; j < nodes; ++j) {
        const auto at = [&](int k) { return (2 * k + 1.0) / nodes - 1; };
        sum += std::pow(index(field, Vec3(at(i), at(j), 1)), 2);
      }
    return sum / (nodes * nodes);
  };
  return std::visit(
      [&]<class F>(const F& field) {
        if constexpr (std::same_as<F, StandingWave>) {
          double sum = 0;
          for (int k = 0; k < phases; ++k)
            sum += mean_of(field.frozen(std::cos((k + 0.5) * std::numbers::pi / phases)));
          return sum / phases;
        } else {
          return mean_of(field);
        }
      },
      scene.field);
}

}  // namespace flatspeckle::bench

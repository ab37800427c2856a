#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "core/numbers/random.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/spline_field.h"
#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::grin::tests {

inline constexpr double pi = std::numbers::pi;

/// A ray of the Luneburg lens of radius 1 in closed form (conventions, C27).
struct LuneburgRay {
  Vec3 x0, v0;

  Vec3 x(double sigma) const { return std::cos(sigma) * x0 + std::sin(sigma) * v0; }
  Vec3 v(double sigma) const { return std::cos(sigma) * v0 - std::sin(sigma) * x0; }
  double optical_path(double sigma) const {
    const double s = std::sin(sigma), s2 = std::sin(2 * sigma) / 4;
    return 2 * sigma - x0.squaredNorm() * (sigma / 2 + s2) - v0.squaredNorm() * (sigma / 2 - s2) -
           x0.dot(v0) * s * s;
  }
};

inline SplineField random_spline(std::uint64_t seed, int nodes = 8, double spacing = 0.5) {
  const FieldGrid grid{Vec3::Zero(), Vec3::Constant(spacing), {nodes, nodes, nodes}};
  RandomStream random(seed, 9, 0);
  std::vector<double> values(grid.size());
  for (double& value : values) value = 0.5 + 0.2 * random.uniform();
  return SplineField(grid, values);
}

template <class Integrator, IndexField F, class Ray, class... Tangent>
void go(const F& field, double sigma, int steps, Ray& ray, Tangent&... tangent) {
  for (int i = 0; i < steps; ++i) Integrator::step(field, ray, tangent..., sigma / steps);
}

}  // namespace flatspeckle::grin::tests

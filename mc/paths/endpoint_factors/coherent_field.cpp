#include "mc/paths/endpoint_factors/coherent_field.h"

#include <algorithm>
#include <cmath>

#include "mc/paths/endpoint_factors/quadrature.h"

namespace flatspeckle::mc {

namespace {

/// The integral along z at one distance from the side x = -width/2, for a light with w.x, w.z >= 0:
/// shallow points were reached through the face z = 0, deeper ones through the side, so the
/// exponent is linear in z on two pieces.
class ColumnIntegral {
 public:
  ColumnIntegral(const Domain& box, Vec2 w, Complex extra, double beta)
      : box_(box), w_(w), extra_(extra), beta_(0, beta) {}

  Complex operator()(double from_side) const {
    const double turn =
        w_.x * box_.depth <= w_.z * from_side ? box_.depth : w_.z * from_side / w_.x;
    Complex sum = 0;
    if (turn > 0) sum = exponential_integral(beta_ + extra_ / w_.z, turn);
    if (turn < box_.depth) {
      const Complex start = std::exp(extra_ * (from_side / w_.x) + beta_ * turn);
      sum += start * exponential_integral(beta_, box_.depth - turn);
    }
    return sum;
  }

 private:
  Domain box_;
  Vec2 w_;
  Complex extra_, beta_;
};

Complex mean_field(const Scene& scene, double light, double view) {
  const auto& box = scene.domain;
  // Mirror the scene so that the light comes from the side x = -width/2 and the face z = 0.
  Vec2 w = direction(light), v = direction(view);
  Complex origin = 1;
  if (w.x < 0) {
    w.x = -w.x;
    v.x = -v.x;
  }
  if (w.z < 0) {  // z -> depth - z
    origin = std::polar(1.0, scene.k * (w.z - v.z) * box.depth);
    w.z = -w.z;
    v.z = -v.z;
  }
  const double alpha = scene.k * (w.x - v.x), beta = scene.k * (w.z - v.z);
  const Complex extra(-scene.medium.mu_t / 2, scene.medium.k_shift);
  const ColumnIntegral column(box, w, extra, beta);
  const auto integrand = [&](double from_side) {
    return std::polar(1.0, alpha * (from_side - box.width / 2)) * column(from_side);
  };
  // Where the ray through the far corner enters, the integrand has a kink.
  const double kink = w.z > 0 ? std::min(box.width, w.x / w.z * box.depth) : box.width;
  const double shaded = w.x > 0 ? kink / w.x : 0;
  const double radians = std::abs(alpha) * kink + (std::abs(beta) * w.z + std::abs(extra)) * shaded;
  const Complex near_side = integrate(integrand, 0, kink, radians);
  const Complex rest = integrate(integrand, kink, box.width, std::abs(alpha) * (box.width - kink));
  return origin * scene.medium.density * amplitude(scene.medium.t_matrix, scene.k, view - light) *
         (near_side + rest);
}

}  // namespace

bool has_coherent_field(const Scene& scene) {
  return scene.domain.kind == Domain::Kind::box && scene.medium.has_scatterers && !scene.profile &&
         (!scene.index || !scene.index->is_around()) &&
         scene.request.lights.all(Light::Kind::plane) &&
         std::none_of(scene.request.views.begin(), scene.request.views.end(),
                      [](const View& view) { return view.near; });
}

std::vector<Complex> coherent_field(const Scene& scene) {
  std::vector<Complex> field;
  for (const auto& [light, view] : scene.request.channels)
    field.push_back(
        mean_field(scene, scene.request.lights[light].angle, scene.request.views[view].angle));
  return field;
}

}  // namespace flatspeckle::mc

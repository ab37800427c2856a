#include "mc/coherent_field.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace flatspeckle::mc {

namespace {

/// int_0^length exp(rate t) dt
Complex exponential_integral(Complex rate, double length) {
  const Complex z = rate * length;
  if (std::abs(z) < 1e-4) return length * (1.0 + z / 2.0 + z * z / 6.0);
  return (std::exp(z) - 1.0) / rate;
}

/// The integral along z at one distance from the side x = -width/2, for a light with w.x, w.z >= 0:
/// shallow points were reached through the face z = 0, deeper ones through the side, so the
/// exponent is linear in z on two pieces.
class Column {
 public:
  Column(const Domain& box, Vec2 w, Complex extra, double beta)
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

/// Eight-point Gauss-Legendre over panels of at most a radian or so.
template <typename F>
Complex integrate(F f, double from, double to, double radians) {
  static constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290,
                                                 0.7966664774136267, 0.9602898564975363};
  static constexpr std::array<double, 4> weight = {0.3626837833783620, 0.3137066458778873,
                                                   0.2223810344533745, 0.1012285362903763};
  const auto panels = static_cast<std::size_t>(std::ceil(radians)) + 1;
  const double half = (to - from) / (2 * static_cast<double>(panels));
  Complex sum = 0;
  for (std::size_t p = 0; p < panels; ++p) {
    const double middle = from + (2 * static_cast<double>(p) + 1) * half;
    for (std::size_t i = 0; i < node.size(); ++i)
      sum += weight[i] * (f(middle - half * node[i]) + f(middle + half * node[i]));
  }
  return half * sum;
}

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
  const Column column(box, w, extra, beta);
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
  return scene.domain.kind == Domain::Kind::box && scene.medium.has_scatterers &&
         std::none_of(scene.request.views.begin(), scene.request.views.end(),
                      [](const View& view) { return view.near; });
}

std::vector<Complex> coherent_field(const Scene& scene) {
  std::vector<Complex> field;
  for (const auto& [light, view] : scene.request.channels)
    field.push_back(
        mean_field(scene, scene.request.lights[light], scene.request.views[view].angle));
  return field;
}

}  // namespace flatspeckle::mc

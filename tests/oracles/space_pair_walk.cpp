#include "tests/oracles/space_pair_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

namespace flatspeckle::oracles {

namespace {

using Complex = std::complex<double>;
using grin::Vec3;

double amplitude(double g, double cosine) {
  return std::sqrt((1 - g * g) / (4 * std::numbers::pi)) *
         std::pow(1 + g * g - 2 * g * cosine, -0.75);
}

/// Returns e_1 conj(e_2) (C13) at depth z, for illuminations along a and b with wavenumbers k and
/// k2.
Complex pair_intensity(double k, double k2, double depth, const Vec3& a, const Vec3& b, double z) {
  const auto loss = [&](double cosine) {
    return (cosine > 0 ? z : depth - z) / (2 * std::abs(cosine));
  };
  return std::exp(Complex(-loss(a.z()) - loss(b.z()), (k * a.z() - k2 * b.z()) * z));
}

Vec3 turned(const Vec3& axis, double g, double u, double azimuth) {
  double cosine = 2 * u - 1;
  if (g != 0) {
    const double s = (1 - g * g) / (1 - g + 2 * g * u);
    cosine = std::clamp((1 + g * g - s * s) / (2 * g), -1.0, 1.0);
  }
  const double sine = std::sqrt(1 - cosine * cosine);
  const Vec3 a = axis.unitOrthogonal(), b = axis.cross(a);
  return cosine * axis + sine * (std::cos(azimuth) * a + std::sin(azimuth) * b);
}

}  // namespace

SpacePairWalk::Estimate SpacePairWalk::estimate(std::uint64_t photons, std::uint64_t seed,
                                                bool single) const {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double k2 = k * (1 + shift);
  const Vec3 momentum = k * light1 - k2 * light2, q(momentum.x(), momentum.y(), 0);
  const double mu = light1.z(), within = -std::expm1(-depth / mu);
  Complex sum = 0;
  double squares = 0;
  for (std::uint64_t photon = 0; photon < photons; ++photon) {
    const double start = -mu * std::log1p(-within * uniform(random));
    Vec3 x(0, 0, start), direction = light1;
    Complex weight = pair_intensity(k, k2, depth, light1, light2, start) * mu * within *
                     std::exp(start / mu),
            found = 0;
    for (int order = 1; x.z() >= 0 && x.z() <= depth; ++order) {
      const Vec3& other = order == 1 ? light2 : direction;
      const Complex seen = pair_intensity(k, k2, depth, -view1, -view2, x.z());
      if (order > 1 || single)
        found += weight * seen * albedo * amplitude(g, direction.dot(view1)) *
                 amplitude(g, other.dot(view2));
      const Vec3 next =
          turned(direction, g, uniform(random), 2 * std::numbers::pi * uniform(random));
      weight *= albedo * amplitude(g, other.dot(next)) / amplitude(g, direction.dot(next));
      const double length = -std::log1p(-uniform(random));
      const Vec3 step = length * next;
      weight *= std::polar(1.0, (k - k2) * length - q.dot(step));
      x += step;
      direction = next;
    }
    sum += found;
    squares += std::norm(found);
  }
  const double n = static_cast<double>(photons);
  return {sum / n, std::sqrt(squares) / n};
}

}  // namespace flatspeckle::oracles

#include "mc/transport/double_scattering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mc/transport/divided_difference.h"
#include "mc/transport/gauss.h"

namespace flatspeckle::mc {

namespace {

using mc::divided_difference;
using std::numbers::pi;

/// The second divided difference of exp: int exp(a x + b y + c z) over x + y + z = 1, x, y, z > 0.
Complex divided_difference(Complex a, Complex b, Complex c) {
  // a and c furthest apart
  const double ab = std::norm(a - b), bc = std::norm(b - c), ca = std::norm(c - a);
  if (ab >= bc && ab >= ca)
    std::swap(b, c);
  else if (bc >= ca)
    std::swap(a, b);
  if (std::norm(a - c) > 0.25)
    return (divided_difference(a, b) - divided_difference(b, c)) / (a - c);
  // exp(m) sum_k h_k / (k + 2)!, h_k the complete symmetric polynomials of the distances from m
  const Complex middle = (a + b + c) / 3.0, x = a - middle, y = b - middle, z = c - middle;
  const Complex second = x * y + y * z + z * x, third = x * y * z;
  std::array<Complex, 3> h{0, 0, 1};  // h_{k-2}, h_{k-1}, h_k; the distances add up to 0
  Complex sum = 0.5;
  double factorial = 2;
  for (int k = 1; k <= 12; ++k) {
    h = {h[1], h[2], -second * h[1] + third * h[0]};
    factorial *= k + 2;
    sum += h[2] / factorial;
  }
  return std::exp(middle) * sum;
}

}  // namespace

DoubleScattering::DoubleScattering(const Scene& scene, double q, Pair lights, Pair views)
    : optical_depth_(scene.medium.mu_t * scene.domain.depth),
      q_(q),
      lights_(lights),
      views_(views),
      light_(pair_wave(scene, lights)),
      view_(pair_wave(scene, turned_round(views))) {}

Complex DoubleScattering::along(double sine, double cosine, bool down) const {
  const Complex loss = Complex(1, q_ * sine) / cosine,
                between = down ? view_.top + light_.bottom : light_.top + view_.bottom;
  return optical_depth_ * optical_depth_ / cosine *
         divided_difference(optical_depth_ * (light_.top + view_.top),
                            optical_depth_ * (between - loss),
                            optical_depth_ * (light_.bottom + view_.bottom));
}

Complex DoubleScattering::gauss(const ScatteringLaw& law, double from, double to) const {
  static const Quadrature rule = gauss_legendre(10);
  Complex sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double theta = from + rule.node[i] * (to - from), cosine = std::cos(theta);
    sum += rule.weight[i] * along(std::sin(theta), std::abs(cosine), cosine > 0) *
           law.pair(lights_.first, lights_.second, theta) *
           law.pair(views_.first, views_.second, theta);
  }
  return (to - from) * sum;
}

Complex DoubleScattering::integral(const ScatteringLaw& law, double from, double to,
                                   double tolerance, Complex estimate, int depth) const {
  constexpr int deepest = 24;
  const double middle = (from + to) / 2;
  const Complex left = gauss(law, from, middle), right = gauss(law, middle, to);
  if (std::abs(left + right - estimate) <= tolerance || depth == deepest) return left + right;
  return integral(law, from, middle, tolerance, left, depth + 1) +
         integral(law, middle, to, tolerance, right, depth + 1);
}

Complex DoubleScattering::total(const ScatteringLaw& law, double tolerance) const {
  std::vector<double> cuts{-pi, -pi / 2, pi / 2, pi};
  for (const double angle : {lights_.first, lights_.second, views_.first, views_.second,
                             (lights_.first + lights_.second) / 2})
    cuts.push_back(std::remainder(angle, 2 * pi));
  std::sort(cuts.begin(), cuts.end());
  Complex sum = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
    if (cuts[i + 1] > cuts[i])
      sum += integral(law, cuts[i], cuts[i + 1], tolerance, gauss(law, cuts[i], cuts[i + 1]), 0);
  return sum;
}

}  // namespace flatspeckle::mc

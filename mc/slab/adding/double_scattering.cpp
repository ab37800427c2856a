#include "mc/slab/adding/double_scattering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/algebra/divided_difference.h"
#include "core/numbers/gauss.h"
#include "core/run/interrupt.h"

namespace flatspeckle::mc {

namespace {

using flatspeckle::divided_difference;
using std::numbers::pi;

/// The second divided difference of exp: int exp(a x + b y + c z) over x + y + z = 1, x, y, z > 0.
template <typename C>
C divided_difference(C a, C b, C c) {
  // a and c furthest apart
  const double ab = std::norm(value_of(a - b)), bc = std::norm(value_of(b - c)),
               ca = std::norm(value_of(c - a));
  if (ab >= bc && ab >= ca)
    std::swap(b, c);
  else if (bc >= ca)
    std::swap(a, b);
  if (std::norm(value_of(a - c)) > 0.25)
    return (divided_difference(a, b) - divided_difference(b, c)) / (a - c);
  // exp(m) sum_k h_k / (k + 2)!, h_k the complete symmetric polynomials of the distances from m
  const C middle = (a + b + c) / 3.0, x = a - middle, y = b - middle, z = c - middle;
  const C second = x * y + y * z + z * x, third = x * y * z;
  // h_{k-2}, h_{k-1}, h_k; the distances add up to 0
  std::array<C, 3> h{C{}, C{}, exp(C{})};
  C sum = 0.5 * h[2];
  double factorial = 2;
  for (int k = 1; k <= 12; ++k) {
    h = {h[1], h[2], third * h[0] - second * h[1]};
    factorial *= k + 2;
    sum += h[2] / factorial;
  }
  return exp(middle) * sum;
}

double magnitude(Complex z) {
  return std::abs(z);
}
double magnitude(const Dual<Complex>& z) {
  return std::max(std::abs(z.value), std::abs(z.slope));
}

}  // namespace

template <typename Number>
DoubleScatteringOf<Number>::DoubleScatteringOf(RealOf<Number> optical_depth, double k, double q,
                                               Pair lights, Pair views,
                                               const Departure<Number>& departure)
    : optical_depth_(optical_depth),
      q_(q * departure.length),
      extinction_(departure.extinction(k)),
      lights_(lights),
      views_(views),
      light_(pair_wave(k, lights, departure)),
      view_(pair_wave(k, turned_round(views), departure)) {}

template <typename Number>
ComplexOf<Number> DoubleScatteringOf<Number>::along(double sine, double cosine, bool down) const {
  const C loss = (as_complex(extinction_) + Complex(0, sine) * q_) / cosine,
          between = down ? view_.top + light_.bottom : light_.top + view_.bottom;
  return optical_depth_ * optical_depth_ / cosine *
         divided_difference(C(optical_depth_ * (light_.top + view_.top)),
                            C(optical_depth_ * (between - loss)),
                            C(optical_depth_ * (light_.bottom + view_.bottom)));
}

template <typename Number>
ComplexOf<Number> DoubleScatteringOf<Number>::gauss(const Law& law, double from, double to) const {
  static const QuadratureRule rule = gauss_legendre(10);
  C sum{};
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double theta = from + rule.node[i] * (to - from), cosine = std::cos(theta);
    sum += rule.weight[i] * (along(std::sin(theta), std::abs(cosine), cosine > 0) *
                             law.pair(lights_.first, lights_.second, theta) *
                             law.pair(views_.first, views_.second, theta));
  }
  return (to - from) * sum;
}

template <typename Number>
ComplexOf<Number> DoubleScatteringOf<Number>::integral(const Law& law, double from, double to,
                                                       double tolerance, C estimate,
                                                       int depth) const {
  constexpr int deepest = 24;
  stop_if_interrupted();
  const double middle = (from + to) / 2;
  const C left = gauss(law, from, middle), right = gauss(law, middle, to);
  if (!(magnitude(left + right - estimate) > tolerance) || depth == deepest) return left + right;
  return integral(law, from, middle, tolerance, left, depth + 1) +
         integral(law, middle, to, tolerance, right, depth + 1);
}

template <typename Number>
ComplexOf<Number> DoubleScatteringOf<Number>::total(const Law& law, double tolerance) const {
  std::vector<double> cuts{-pi, -pi / 2, pi / 2, pi};
  for (const double angle : {lights_.first, lights_.second, views_.first, views_.second,
                             (lights_.first + lights_.second) / 2})
    cuts.push_back(std::remainder(angle, 2 * pi));
  std::sort(cuts.begin(), cuts.end());
  C sum{};
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
    if (cuts[i + 1] > cuts[i])
      sum += integral(law, cuts[i], cuts[i + 1], tolerance, gauss(law, cuts[i], cuts[i + 1]), 0);
  return sum;
}

template class DoubleScatteringOf<double>;
template class DoubleScatteringOf<Complex>;
template class DoubleScatteringOf<Dual<double>>;

}  // namespace flatspeckle::mc

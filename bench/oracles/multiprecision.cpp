#include "bench/oracles/multiprecision.h"

#include <boost/math/special_functions/bessel_prime.hpp>

namespace flatspeckle::oracles {

std::vector<WideComplex> wide_bessel_ratios(int order, const WideComplex& z) {
  const int start = order + 100 + static_cast<int>(1.5 * static_cast<double>(abs(z)));
  std::vector<WideComplex> ratios(order + 1);
  WideComplex ratio = 0;
  for (int n = start; n >= 0; --n) {
    ratio = 1 / (WideComplex(2 * (n + 1)) / z - ratio);
    if (n <= order) ratios[n] = ratio;
  }
  return ratios;
}

WideComplex wide_t(const Scatterer& cylinder, double k, int n) {
  using Kind = Scatterer::Kind;
  const Wide x(k * cylinder.radius);
  const Wide j = boost::math::cyl_bessel_j(n, x),
             j_derivative = boost::math::cyl_bessel_j_prime(n, x);
  const WideComplex h(j, boost::math::cyl_neumann(n, x)),
      h_derivative(j_derivative, boost::math::cyl_neumann_prime(n, x));
  if (cylinder.kind == Kind::soft) return -j / h;
  if (cylinder.kind == Kind::hard) return -j_derivative / h_derivative;
  const WideComplex m(Wide(cylinder.index.real()), Wide(cylinder.index.imag())), mx = m * x;
  const WideComplex q = cylinder.kind == Kind::tm ? m : WideComplex(1 / m);
  const WideComplex inside = q * (n / mx - wide_bessel_ratios(n, mx)[n]);  // q J'/J
  return -(inside * j - j_derivative) / (inside * h - h_derivative);
}

}  // namespace flatspeckle::oracles

#include "bench/oracles/peierls_slab.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/expint.hpp>

namespace flatspeckle::oracles {
namespace {

double e(unsigned n, double x) {
  return boost::math::expint(n, x);
}

using Values = std::vector<double>;  // mean values in cells of equal thickness

/// Applies (1/2) int E1(|x - x'|) f(x') dx', averaged over the cells, by differences of E3 (E3'' =
/// E1).
class PeierlsOperator {
 public:
  PeierlsOperator(double optical_depth, int cells) : of_distance_(cells) {
    const double h = optical_depth / cells;
    of_distance_[0] = (e(3, h) - 0.5 + h) / h;
    for (int k = 1; k < cells; ++k)
      of_distance_[k] = (e(3, (k - 1) * h) - 2 * e(3, k * h) + e(3, (k + 1) * h)) / (2 * h);
  }

  Values operator()(const Values& f) const {
    const int cells = static_cast<int>(f.size());
    Values result(cells, 0.0);
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j) result[i] += of_distance_[std::abs(i - j)] * f[j];
    return result;
  }

 private:
  Values of_distance_;
};

double largest_eigenvalue(const PeierlsOperator& peierls, int cells) {
  Values v(cells, 1.0);
  for (double value = 0;;) {
    Values w = peierls(v);
    const double next = *std::max_element(w.begin(), w.end());
    for (double& x : w) x /= next;
    v = w;
    if (std::abs(next - value) < 1e-13) return next;
    value = next;
  }
}

constexpr int coarse = 100;

double eigenvalue(double optical_depth) {
  const double rough = largest_eigenvalue({optical_depth, coarse}, coarse);
  const double fine = largest_eigenvalue({optical_depth, 2 * coarse}, 2 * coarse);
  return (4 * fine - rough) / 3;
}

/// Sums the orders of scattering.
Values fluence(const PeierlsOperator& peierls, double albedo, const Values& unscattered) {
  Values total = unscattered, order = unscattered;
  while (*std::max_element(order.begin(), order.end()) > 1e-13) {
    order = peierls(order);
    for (std::size_t i = 0; i < order.size(); ++i) total[i] += order[i] *= albedo;
  }
  return total;
}

SlabShares slab_on_cells(double optical_depth, double albedo, int cells) {
  const double h = optical_depth / cells;
  Values beam(cells), out(cells);  // exp(-x) and E2(x)
  for (int i = 0; i < cells; ++i) {
    beam[i] = std::exp(-i * h) * -std::expm1(-h) / h;
    out[i] = (e(3, i * h) - e(3, (i + 1) * h)) / h;
  }
  const Values phi = fluence({optical_depth, cells}, albedo, beam);
  const double scale = albedo / 2 * h;
  return {scale * std::inner_product(out.begin(), out.end(), phi.begin(), 0.0),
          std::exp(-optical_depth) +
              scale * std::inner_product(out.rbegin(), out.rend(), phi.begin(), 0.0)};
}

}  // namespace

SlabShares isotropic_slab(double optical_depth, double albedo) {
  const SlabShares rough = slab_on_cells(optical_depth, albedo, 2 * coarse);
  const SlabShares fine = slab_on_cells(optical_depth, albedo, 4 * coarse);
  return {(4 * fine.reflected - rough.reflected) / 3,
          (4 * fine.transmitted - rough.transmitted) / 3};
}

double critical_ratio(double optical_depth) {
  return 1 / eigenvalue(optical_depth);
}

double slab_decay_rate(double length, double mu_s, double mu_a) {
  double low = 0, high = mu_s;  // bounds of mu_s - rate
  for (int i = 0; i < 40; ++i) {
    const double left = (low + high) / 2;
    (mu_s / left > critical_ratio(left * length) ? low : high) = left;
  }
  return mu_s - (low + high) / 2 + mu_a;
}

double diffusion_decay_rate(double length, double mu_s_reduced, double mu_a) {
  const double wave_number = std::numbers::pi / (length + 2 * 0.7104 / mu_s_reduced);
  return mu_a + wave_number * wave_number / (3 * mu_s_reduced);
}

double isotropic_half_space(double albedo) {
  // ln H(mu) = -(mu/pi) int_0^(pi/2) ln(1 - albedo theta cot theta)/(cos^2 + mu^2 sin^2) dtheta,
  // Chandrasekhar's solution with z = i cot(theta) on the imaginary axis; mu = 1.
  const auto integrand = [&](double theta) {
    return std::log(1 - albedo * theta / std::tan(theta));
  };
  const double integral =
      boost::math::quadrature::gauss<double, 60>::integrate(integrand, 0, std::numbers::pi / 2);
  return 1 - std::sqrt(1 - albedo) * std::exp(-integral / std::numbers::pi);
}

}  // namespace flatspeckle::oracles

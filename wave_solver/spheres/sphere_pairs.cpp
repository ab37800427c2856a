#include "wave_solver/spheres/sphere_pairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/spheres/harmonics.h"

namespace flatspeckle::wave {

namespace {

/// Waves of one order m about one sphere of a pair, for the degrees l = m ..
struct AxialSide {
  int m;
  std::vector<ScaledReal> sigma;
  std::vector<Complex> diagonal;

  AxialSide(const std::vector<ScaledComplex>& t, int of_order) : m(of_order) {
    for (std::size_t l = m; l < t.size(); ++l) {
      const ScaledReal size = abs(t[l]);
      sigma.push_back(sqrt(size));
      diagonal.push_back(size.value() > 0 ? -static_cast<Complex>(size / t[l]) : Complex(1));
    }
  }
  std::size_t size() const { return sigma.size(); }
  // Writes -sigma a of the plane wave along w, divided by sqrt(4 pi). harmonics: of w.
  void light(const std::vector<double>& harmonics, Complex there, Complex* column) const {
    constexpr Complex power[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    for (std::size_t i = 0; i < size(); ++i) {
      const int l = m + static_cast<int>(i);
      column[i] = -std::sqrt(4 * std::numbers::pi) * there * power[l % 4] *
                  (static_cast<double>(sigma[i]) * harmonics[harmonic_index(l, m)]);
    }
  }
};

/// Returns the translation of waves of order m along +z over x = k d: [l' of the sender - m][l of
/// the receiver - m]. From d/dz of the waves (C61):
///   c_l' S_l,l'+1 = c_l'-1 S_l,l'-1 - c_l S_l+1,l' + c_l-1 S_l-1,l',
///   c_l^2 = ((l + 1)^2 - m^2) / ((2 l + 1) (2 l + 3)).
std::vector<std::vector<ScaledComplex>> axial_translation(std::size_t receivers,
                                                          std::size_t senders, int m, double x) {
  const auto c = [m](std::size_t i) {
    const auto l = static_cast<long double>(i) + m;
    return std::sqrt((l + 1 - m) * (l + 1 + m) / ((2 * l + 1) * (2 * l + 3)));
  };
  const std::size_t all = receivers + senders;
  const auto h = scaled_hankel(static_cast<int>(all) + m, x, Radial::spherical);
  std::vector<std::vector<ScaledComplex>> s(senders);
  for (std::size_t i = 0; i < all && senders > 0; ++i) {
    const auto l = static_cast<long double>(i) + m;
    const long double size =
        m == 0 ? std::sqrt(2 * l + 1) : std::sqrt(1.5L * l * (l + 1) * (2 * l + 1)) / x;
    s[0].push_back((i % 2 == 0 ? size : -size) * h[i + m]);
  }
  for (std::size_t other = 0; other + 1 < senders; ++other)
    for (std::size_t i = 0; i + 1 < s[other].size(); ++i) {
      ScaledComplex sum = -(c(i) * s[other][i + 1]);
      if (other > 0) sum = sum + c(other - 1) * s[other - 1][i];
      if (i > 0) sum = sum + c(i - 1) * s[other][i - 1];
      s[other + 1].push_back((1 / c(other)) * sum);
    }
  return s;
}

/// Returns |beta_lm| / sqrt(4 pi) of the first sphere for plane waves along several directions, the
/// largest for each degree; empty if no solution is found.
std::vector<double> response(const AxialSide& first, const AxialSide& second, double k,
                             double distance) {
  const std::size_t rows = first.size(), n = rows + second.size();
  std::vector<double> strength(rows);
  if (rows == 0) return strength;
  std::vector<Complex> matrix(n * n);
  for (std::size_t i = 0; i < n; ++i)
    matrix[i * (n + 1)] = i < rows ? first.diagonal[i] : second.diagonal[i - rows];
  const auto s = axial_translation(second.size(), rows, first.m, k * distance);
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < second.size(); ++i)
      matrix[j * n + rows + i] = static_cast<Complex>(s[j][i] * second.sigma[i] * first.sigma[j]);
  if (!factor_symmetric(matrix.data(), n, n)) return {};
  const std::vector<double> angles = first.m == 0
                                         ? std::vector{0.0, std::numbers::pi}
                                         : std::vector{std::numbers::pi / 4, std::numbers::pi / 2};
  const Harmonics harmonics(static_cast<int>(std::max(rows, second.size())) + first.m);
  std::vector<Complex> x(angles.size() * n);
  for (std::size_t light = 0; light < angles.size(); ++light) {
    const Vec w = direction(angles[light]);
    const auto values = harmonics.at(w);
    first.light(values, 1, &x[light * n]);
    second.light(values, std::polar(1.0, k * distance * w.z), &x[light * n] + rows);
  }
  solve_forward(matrix.data(), n, n, x.data(), angles.size(), n);
  solve_backward(matrix.data(), n, n, x.data(), angles.size(), n);
  for (std::size_t light = 0; light < angles.size(); ++light)
    for (std::size_t i = 0; i < rows; ++i) {
      strength[i] = std::max(strength[i], std::abs(x[light * n + i]));
      if (!std::isfinite(std::abs(x[light * n + i]))) return {};
    }
  return strength;
}

std::vector<double> pair_of_spheres(const std::vector<ScaledComplex>& t_first,
                                    const std::vector<ScaledComplex>& t_second, double k,
                                    double distance) {
  std::vector<double> strength(t_first.size());
  for (const int m : {0, 1}) {
    const auto own = response({t_first, m}, {t_second, m}, k, distance);
    if (own.empty() && t_first.size() > static_cast<std::size_t>(m)) return {};
    for (std::size_t i = 0; i < own.size(); ++i)
      strength[i + m] = std::max(strength[i + m], own[i]);
  }
  return strength;
}

}  // namespace

OrderRules sphere_rules() {
  return {Radial::spherical, highest_degree, pair_of_spheres};
}

}  // namespace flatspeckle::wave

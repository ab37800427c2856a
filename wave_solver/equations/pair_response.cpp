#include "wave_solver/equations/pair_response.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numbers/complex.h"
#include "wave_solver/dense/symmetric_factor.h"
#include "wave_solver/equations/cylinder_waves.h"

namespace flatspeckle::wave {

namespace {

// Waves of one parity about a scatterer; with both centres on the z axis the parities do not mix.
struct Side {
  std::vector<Mode> modes;
  std::vector<Complex> diagonal;
  Vec2 centre;

  Side(const std::vector<ScaledComplex>& t, bool odd, Vec2 at) : centre(at) {
    for (int n = odd ? 1 : 0; n < static_cast<int>(t.size()); ++n) {
      const ScaledReal size = abs(t[n]), sigma = sqrt(size);
      modes.push_back({n, odd, n == 0 ? root_half * sigma : sigma});
      diagonal.push_back(size.value() > 0 ? -static_cast<Complex>(size / t[n]) : Complex(1));
    }
  }
  ModeSet set() const { return {centre, modes, modes.empty() ? 0 : modes.back().order}; }
  // -sigma a of the plane wave from an angle
  void light(double angle, double k, Complex* column) const {
    const Vec2 w = direction(angle);
    const Complex there = std::numbers::sqrt2 * std::polar(1.0, k * dot(w, centre));
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const int n = modes[i].order;
      const double turned = modes[i].odd ? std::sin(n * angle) : std::cos(n * angle);
      constexpr Complex power[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
      column[i] = -there * static_cast<double>(modes[i].weight) * turned * power[n % 4];
    }
  }
};

// beta of the first scatterer for some lights: [light][mode]; empty where no solution is found.
std::vector<Complex> solved(const Side& first, const Side& second, double k) {
  const std::size_t rows = first.modes.size(), n = rows + second.modes.size();
  std::vector<Complex> matrix(n * n);
  for (std::size_t i = 0; i < n; ++i)
    matrix[i * (n + 1)] = i < rows ? first.diagonal[i] : second.diagonal[i - rows];
  const ModeSet receiver = second.set();
  if (rows > 0 && n > rows) translate(k, {&receiver, 1}, first.set(), {&matrix[rows], n});
  if (!factor_symmetric(matrix.data(), n, n)) return {};
  constexpr int lights = 5;
  std::vector<Complex> x(lights * n);
  for (int i = 0; i < lights; ++i) {
    const double angle = i * std::numbers::pi / (lights - 1);
    first.light(angle, k, &x[i * n]);
    second.light(angle, k, &x[i * n] + rows);
  }
  solve_forward(matrix.data(), n, n, x.data(), lights, n);
  solve_backward(matrix.data(), n, n, x.data(), lights, n);
  std::vector<Complex> beta;
  for (int i = 0; i < lights; ++i) beta.insert(beta.end(), &x[i * n], &x[i * n] + rows);
  return beta;
}

}  // namespace

std::vector<double> pair_response(const std::vector<ScaledComplex>& t_first,
                                  const std::vector<ScaledComplex>& t_second, double k,
                                  double distance) {
  std::vector<double> strength(t_first.size());
  for (const bool odd : {false, true}) {
    const Side first(t_first, odd, {0, 0}), second(t_second, odd, {0, distance});
    const auto beta = solved(first, second, k);
    const std::size_t count = first.modes.size();
    if (beta.empty() && count > 0) return {};
    for (std::size_t i = 0; i < beta.size(); ++i) {
      double& largest = strength[first.modes[i % count].order];
      largest = std::max(largest, std::abs(beta[i]));
      if (!std::isfinite(std::abs(beta[i]))) return {};
    }
  }
  return strength;
}

}  // namespace flatspeckle::wave

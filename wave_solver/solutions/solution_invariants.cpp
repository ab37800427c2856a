#include "wave_solver/solutions/solution_invariants.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/rim_waves.h"

namespace flatspeckle::wave {

namespace {

// Returns, for each unknown of a scatterer, the power that the scatterer absorbs if this unknown
// has the absolute value 1.
std::vector<double> absorption_of(const TMatrixSystem& system, std::size_t j) {
  const Scatterer& own = system.placement()[j].scatterer;
  std::vector<double> absorbed(system.first(j + 1) - system.first(j));
  if (own.kind == Scatterer::Kind::point)
    absorbed[0] = 4 / system.k() * system.strength(system.first(j)) * (1 / own.albedo - 1);
  if (!own.is_penetrable() || own.index.imag() == 0) return absorbed;
  const auto waves = rim_waves(own, system.k(), system.order(j));
  for (std::size_t i = 0; i < absorbed.size(); ++i) {
    const RimWave& wave = waves[(i + 1) / 2];
    absorbed[i] = static_cast<double>(-2 * std::numbers::pi_v<long double> * own.radius *
                                      (std::conj(wave.field) * wave.derivative).imag());
  }
  return absorbed;
}

// Returns equally spaced directions, as many as are required to integrate |A|^2 exactly. |A|^2
// contains angular orders up to about 2 k R.
std::vector<double> directions_around(const TMatrixSystem& system) {
  const double size = system.k() * enclosing_circle(system.placement()).radius;
  const int count = 2 * static_cast<int>(size + 10 * std::cbrt(size) + 20);
  std::vector<double> angles;
  for (int i = 0; i < count; ++i) angles.push_back(2 * std::numbers::pi * i / count);
  return angles;
}

// Returns the integral of |A|^2 over all directions for each light in the list.
std::vector<double> scattered_powers(const WaveSolution& solution,
                                     const std::vector<std::size_t>& lights) {
  constexpr std::size_t at_once = 128;
  const TMatrixSystem& system = solution.system();
  const auto angles = directions_around(system);
  std::vector<double> powers(lights.size());
  if (system.unknowns() == 0) return powers;
  for (std::size_t first = 0; first < angles.size(); first += at_once) {
    const std::size_t count = std::min(at_once, angles.size() - first);
    const auto rows = system.far_rows(std::span(angles).subspan(first, count));
    for (std::size_t i = 0; i < lights.size(); ++i)
      for (const Complex amplitude :
           transposed_product(rows, solution.coefficients(lights[i]).data(), 1, system.unknowns()))
        powers[i] +=
            std::norm(amplitude) * 2 * std::numbers::pi / static_cast<double>(angles.size());
  }
  return powers;
}

}  // namespace

std::vector<double> absorption_of(const TMatrixSystem& system) {
  std::vector<double> absorbed;
  for (std::size_t j = 0; j < system.placement().size(); ++j) {
    const auto own = absorption_of(system, j);
    absorbed.insert(absorbed.end(), own.begin(), own.end());
  }
  return absorbed;
}

Invariant power_balance(const WaveSolution& solution, double tolerance) {
  constexpr std::size_t most_lights = 4, uncombined = 8;
  const TMatrixSystem& system = solution.system();
  const auto& lights = solution.light_angles();
  const Circle circle = enclosing_circle(system.placement());
  const double phases = system.k() * (length(circle.centre) + circle.radius);
  const double slack = 1e-13 + 1e-15 * phases + 100 * std::max(0.0, solution.diagnosis().residual) +
                       (lights.size() > uncombined ? 3 * tolerance : 0);
  const auto absorption = absorption_of(system);
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < std::min(lights.size(), most_lights); ++i)
    some.push_back(i * lights.size() / std::min(lights.size(), most_lights));
  const auto powers = scattered_powers(solution, some);
  Invariant worst;
  for (std::size_t i = 0; i < some.size(); ++i) {
    const std::size_t light = some[i];
    const double scattered = powers[i];
    double absorbed = 0, squares = 0;
    const auto beta = solution.coefficients(light);
    for (std::size_t n = 0; n < beta.size(); ++n) {
      absorbed += absorption[n] * std::norm(beta[n]);
      squares += 4 / system.k() * std::norm(beta[n]);
    }
    const Complex forward = std::sqrt(8 * std::numbers::pi / system.k()) *
                            std::polar(1.0, std::numbers::pi / 4) *
                            solution.fields(std::vector{far_view(lights[light])}, light)[0];
    const double all = std::max(-forward.real(), scattered + absorbed);
    if (all == 0) continue;
    const Invariant found{std::abs(-forward.real() - scattered - absorbed) / all,
                          slack * (std::abs(forward) + squares) / all};
    if (i == 0 || found.is_worse_than(worst)) worst = found;
  }
  return worst;
}

}  // namespace flatspeckle::wave

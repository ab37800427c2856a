#include "wave_solver/equations/t_matrix_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/numbers/bessel.h"
#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/cylinder_waves.h"
#include "wave_solver/equations/neighbours.h"
#include "wave_solver/equations/rim_waves.h"

namespace flatspeckle::wave {

namespace {

// Waves of one parity (cos or sin) about one scatterer of a pair. Both centres are on the z axis,
// so that the parities do not mix.
struct Side {
  std::vector<Mode> modes;
  std::vector<Complex> diagonal;
  Vec centre;

  Side(const std::vector<ScaledComplex>& t, bool odd, Vec at) : centre(at) {
    for (int n = odd ? 1 : 0; n < static_cast<int>(t.size()); ++n) {
      const ScaledReal size = abs(t[n]), sigma = sqrt(size);
      modes.push_back({n, odd, n == 0 ? root_half * sigma : sigma});
      diagonal.push_back(size.value() > 0 ? -static_cast<Complex>(size / t[n]) : Complex(1));
    }
  }
  ModeSet set() const { return {centre, modes, modes.empty() ? 0 : modes.back().order}; }
  // Writes the right-hand side -sigma a of the plane wave with the given angle.
  void light(double angle, double k, Complex* column) const {
    const Vec w = direction(angle);
    const Complex there = std::numbers::sqrt2 * std::polar(1.0, k * dot(w, centre));
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const int n = modes[i].order;
      const double turned = modes[i].odd ? std::sin(n * angle) : std::cos(n * angle);
      constexpr Complex power[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
      column[i] = -there * static_cast<double>(modes[i].weight) * turned * power[n % 4];
    }
  }
};

// Returns the coefficients beta (TMatrixSystem) of the first scatterer of a pair for plane waves
// from several directions: [light][mode]. Returns an empty result if no solution is found.
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

/// Solves the equations of an isolated pair under plane waves. Returns, for each order n of the
/// first scatterer, the largest coefficient |beta_n| (TMatrixSystem) over the directions of the
/// light. By reciprocity, omitting order n changes far fields by about |beta_n|^2. t_first,
/// t_second: T_n up to the highest orders that are included. Returns an empty result if no solution
/// is found.
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

}  // namespace

Basis basis(const Placement& placement, double k, double tolerance, std::span<const Vec> sensors,
            double growth) {
  BasisOrders orders(k, tolerance, {Radial::cylindrical, highest_order, pair_response});
  return orders.basis(placement, sensors, growth);
}

Placement with_copies(const Placement& placement, const Copies& copies) {
  Placement all = placement;
  for (int n = 1; n <= copies.count; ++n)
    for (const int side : {-n, n})
      for (const PlacedScatterer& placed : placement)
        all.push_back({placed.position + Vec{side * copies.period, 0}, placed.scatterer});
  return all;
}

TMatrixSystem::TMatrixSystem(Placement placement, double k, double tolerance,
                             std::span<const Vec> sensors, double growth, const Copies& copies)
    : WaveEquations(k, copies), placement_(std::move(placement)) {
  const auto [t, gap_plasmons] =
      basis(with_copies(placement_, {copies.period, 0, std::min(copies.count, 1)}), k, tolerance,
            sensors, growth);
  has_gap_plasmons_ = gap_plasmons;
  std::vector<Mode> modes;
  std::vector<Complex> diagonal;
  for (std::size_t j = 0; j < placement_.size(); ++j) {
    t_.emplace_back();
    modes.clear();
    diagonal.clear();
    for (int n = 0; n < static_cast<int>(t[j].size()); ++n) {
      const ScaledReal size = abs(t[j][n]), sigma = sqrt(size);
      t_[j].push_back(static_cast<ExtendedComplex>(t[j][n]));
      for (const bool odd : {false, true}) {
        if (n == 0 && odd) continue;
        modes.push_back({n, odd, n == 0 ? root_half * sigma : sigma});
        diagonal.push_back(size.value() > 0 ? -static_cast<Complex>(size / t[j][n]) : Complex(1));
      }
    }
    add({placement_[j].position, placement_[j].scatterer.disk_radius()}, modes, diagonal);
  }
}

TMatrixSystem TMatrixSystem::with_explicit_copies() const {
  TMatrixSystem all(k());
  all.placement_ = with_copies(placement_, copies());
  all.has_gap_plasmons_ = has_gap_plasmons_;
  std::vector<Complex> own;
  for (std::size_t i = 0; i < all.placement_.size(); ++i) {
    const std::size_t j = i % placement_.size();
    own.clear();
    for (std::size_t u = first(j); u < first(j + 1); ++u) own.push_back(diagonal(u));
    all.t_.push_back(t_[j]);
    all.add({all.placement_[i].position, bodies()[j].radius}, modes(j).modes, own);
  }
  return all;
}

// Uses finite differences in k, with a relative step that long double resolves and that is far
// below the width of resonances.
std::vector<Complex> TMatrixSystem::radius_derivatives() const {
  constexpr double step = 0x1p-36;
  std::map<std::pair<std::size_t, int>, std::vector<Complex>> known;
  std::vector<Scatterer> species;
  std::vector<Complex> derivatives;
  for (std::size_t j = 0; j < placement_.size(); ++j) {
    const Scatterer& own = placement_[j].scatterer;
    const auto number = static_cast<std::size_t>(std::ranges::find(species, own) - species.begin());
    if (number == species.size()) species.push_back(own);
    auto& of_order = known[{number, order(j)}];
    if (of_order.empty()) {
      const auto there = scaled_t_matrix(own, k() * (1 + step), order(j)),
                 here = scaled_t_matrix(own, k(), order(j));
      for (std::size_t n = 0; n < here.size(); ++n)
        of_order.push_back(here[n].value() == 0.0L
                               ? Complex()
                               : Complex((static_cast<ExtendedComplex>(there[n] / here[n]) - 1.0L) /
                                         static_cast<long double>(step)));
    }
    for (std::size_t n = 0; n < of_order.size(); ++n)
      derivatives.insert(derivatives.end(), n == 0 ? 1 : 2, of_order[n]);
  }
  return derivatives;
}

std::vector<Complex> TMatrixSystem::source_right_hand_side(Vec source) const {
  require_outside(placement_, source);
  auto side = outside_row(source);
  for (Complex& value : side) value *= Complex(0, -0.25);
  return side;
}

}  // namespace flatspeckle::wave

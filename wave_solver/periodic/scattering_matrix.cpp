#include "wave_solver/periodic/scattering_matrix.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "core/error.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/solutions/solution_invariants.h"

namespace flatspeckle::wave {

namespace {

constexpr std::size_t at_once = 256;    // columns that are computed and stored at once
constexpr double skeleton_share = 0.1;  // tolerance of skeletons, relative to that of the result
constexpr std::size_t most_compared = 200'000;  // unknowns for which unit cells are compared
constexpr double other_start = 1.0 / 3;  // far from the boundaries of halved boxes, on all levels

std::vector<WaveDirection> directions(const std::vector<CellChannel>& channels, bool lights) {
  std::vector<WaveDirection> waves;
  for (const bool front : {true, false})
    for (const CellChannel& channel : channels)
      waves.emplace_back(channel.sine, front == lights ? channel.cosine : -channel.cosine);
  return waves;
}

/// Right-hand sides and solutions of the channels first, first + 1, ...
using SolvedChannels = std::function<void(std::size_t first, const std::vector<Complex>& rhs,
                                          const std::vector<Complex>& solutions)>;

// Adds the scattered waves to S, and calls `solved` for the solutions.
void solve_channels(const PeriodicCell& cell, const PeriodicCell::Solver& solver,
                    ScatteringMatrix& found, const SolvedChannels& solved) {
  const std::size_t n = solver.unknowns.size(), size = found.size(), half = found.channels.size();
  const double k = cell.near().k();
  const auto lights = directions(found.channels, true),
             outgoing = directions(found.channels, false);
  for (std::size_t first = 0; first < size; first += at_once) {
    const std::size_t columns = std::min(at_once, size - first);
    const auto rhs =
        cell.right_hand_sides(std::span(lights).subspan(first, columns), solver.unknowns);
    const auto x = cell.solve(solver, rhs).x;
    if (solved) solved(first, rhs, x);
    for (std::size_t row = 0; row < size; row += at_once) {
      const std::size_t count = std::min(at_once, size - row);
      const auto amplitudes = transposed_product(
          cell.outgoing_rows(std::span(outgoing).subspan(row, count), solver.unknowns), x.data(),
          columns, n);
      for (std::size_t j = 0; j < columns; ++j)
        for (std::size_t i = 0; i < count; ++i)
          found.s[row + i + size * (first + j)] +=
              amplitudes[i + count * j] /
              (k * std::sqrt(found.channels[(row + i) % half].cosine *
                             found.channels[(first + j) % half].cosine));
    }
  }
}

// Solves for all unknowns, with the residual and the absorbed power.
void solve_whole(const PeriodicCell& cell, Method method, double tolerance,
                 const std::vector<double>& absorption, ScatteringMatrix& found) {
  const std::size_t n = cell.unknowns(), half = found.channels.size();
  EquationSolver solver(cell.equations(), method, tolerance);
  std::vector<double> weights;
  for (std::size_t i = 0; i < n; ++i) weights.push_back(cell.near().strength(i));
  found.residual = 0;
  solve_channels(
      cell, cell.whole(solver), found, [&](std::size_t first, const auto& rhs, const auto& x) {
        found.residual =
            std::max(found.residual, relative_size(solver.combined_residual(), rhs, weights));
        for (std::size_t j = 0; j < x.size() / n; ++j) {
          const double incident = cell.period().width * found.channels[(first + j) % half].cosine;
          for (std::size_t i = 0; i < n; ++i)
            found.absorbed[first + j] += absorption[i] * std::norm(x[i + n * j]) / incident;
        }
      });
  found.method = solver.description();
}

// Solves for the waves outside of the slab alone, for scatterers that absorb nothing.
void solve_reduced(const PeriodicCell& cell, double tolerance, ScatteringMatrix& found) {
  const auto solver = cell.reduced(skeleton_share * tolerance);
  solve_channels(cell, solver, found, nullptr);
  found.method =
      "recursive skeletonization to " + std::to_string(solver.unknowns.size()) + " unknowns";
}

double allowed_error(const ScatteringMatrix& found, const SolveOptions& options) {
  return 1e-12 + 100 * options.tolerance + 100 * std::max(found.residual, 0.0);
}

double power_error(const ScatteringMatrix& found) {
  const std::size_t size = found.size();
  std::vector<Complex> gram(size * size);
  cblas_zherk(CblasColMajor, CblasLower, CblasConjTrans, blas_size(size), blas_size(size), 1,
              found.s.data(), blas_size(size), 0, gram.data(), blas_size(size));
  const bool lossless = std::ranges::all_of(found.absorbed, [](double part) { return part == 0; });
  double worst = 0;
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = j; i < (lossless ? size : j + 1); ++i)
      worst = std::max(worst, std::abs(gram[i + size * j] - (i == j ? 1 - found.absorbed[j] : 0)));
  return worst;
}

double reciprocity_error(const ScatteringMatrix& found) {
  const std::size_t size = found.size(), half = found.channels.size();
  const auto reversed = [&](std::size_t i) {
    return i < half ? half - 1 - i : size + half - 1 - i;
  };
  double worst = 0;
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i)
      worst = std::max(worst,
                       std::abs(found.s[i + size * j] - found.s[reversed(j) + size * reversed(i)]));
  return worst;
}

}  // namespace

Method cell_method(std::size_t unknowns, const SolveOptions& options) {
  return options.method == Method::automatic ? method_for(unknowns, options.tolerance)
                                             : options.method;
}

Placement in_one_cell(Placement placement, double width, double start) {
  double low = placement.empty() ? 0 : placement.front().position.x;
  for (const auto& placed : placement) low = std::min(low, placed.position.x);
  low += start * width;
  for (auto& placed : placement)
    placed.position.x -= width * std::floor((placed.position.x - low) / width);
  return placement;
}

Rectangle region_of(const Placement& placement) {
  if (placement.empty()) return {};
  const Rectangle region = bounds_of(placement, &PlacedScatterer::position);
  double radius = 0;
  for (const auto& placed : placement) radius = std::max(radius, placed.scatterer.disk_radius());
  return {region.low - Vec{radius, radius}, region.high + Vec{radius, radius}};
}

std::vector<Complex> ScatteringMatrix::quarter(bool back_light, bool back) const {
  const std::size_t n = channels.size();
  std::vector<Complex> part;
  for (std::size_t j = 0; j < n; ++j) {
    const auto first = s.begin() + static_cast<std::ptrdiff_t>((back_light ? n : 0) * size() +
                                                               j * size() + (back ? n : 0));
    part.insert(part.end(), first, first + static_cast<std::ptrdiff_t>(n));
  }
  return part;
}

ScatteringMatrix scattering_matrix(const Placement& placement, double k, const Period& period,
                                   const SolveOptions& options) {
  const Placement moved = in_one_cell(placement, period.width);
  return scattering_matrix_in_region(
      moved, k, cell_images(k, period, region_of(moved), image_tolerance(options.tolerance)),
      options);
}

ScatteringMatrix scattering_matrix_in_region(const Placement& placement, double k,
                                             const CellImages& images,
                                             const SolveOptions& options) {
  const Period& period = images.period;
  const PeriodicCell cell(placement, k, images, options.tolerance);
  ScatteringMatrix found{channels_of(k, period), {}, {}, -1, cell.unknowns(), {}};
  const std::size_t size = found.size(), half = found.channels.size();
  if (half == 0)
    throw InputError("period", period.width, "has no propagating channel at this wavelength");
  found.s.resize(size * size);
  found.absorbed.resize(size);
  for (std::size_t i = 0; i < size; ++i)  // without scatterers all light is transmitted
    found.s[(i + half) % size + size * i] = 1;
  if (cell.unknowns() > 0) {
    const Method method = cell_method(cell.unknowns(), options);
    const auto absorption = absorption_of(cell.near());
    if (method == Method::fast && std::ranges::all_of(absorption, [](double a) { return a == 0; }))
      solve_reduced(cell, options.tolerance, found);
    else
      solve_whole(cell, method, options.tolerance, absorption, found);
  }
  const double slack = allowed_error(found, options);
  found.power = {power_error(found), slack};
  if (cell.symmetric()) found.reciprocity = {reciprocity_error(found), slack};
  return found;
}

void compare_unit_cells(ScatteringMatrix& found, const Placement& placement, double k,
                        const Period& period, const SolveOptions& options) {
  if (found.residual >= 0 || found.unknowns == 0) return;
  if (found.unknowns > most_compared) {
    found.method += "; too large to compare unit cells";
    return;
  }
  const auto other =
      scattering_matrix(in_one_cell(placement, period.width, other_start), k, period, options);
  found.unit_cell.limit = allowed_error(found, options);
  for (std::size_t i = 0; i < found.s.size(); ++i)
    found.unit_cell.off = std::max(found.unit_cell.off, std::abs(found.s[i] - other.s[i]));
}

}  // namespace flatspeckle::wave

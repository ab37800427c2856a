#include "wave_solver/periodic/periodic_cell.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/sums/fast_product.h"

namespace flatspeckle::wave {

namespace {

Placement checked(const Placement& placement, const Period& period) {
  check_no_overlap(placement);
  try {
    check_no_overlap(with_copies(placement, {period.width, 0, 1}));
  } catch (const InputError&) {
    throw InputError("period", period.width,
                     "scatterers overlap with those of the next period; increase the period");
  }
  return placement;
}

void append(std::vector<Complex>& all, const std::vector<Complex>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

std::vector<WaveDirection> reversed(const std::vector<WaveDirection>& waves) {
  std::vector<WaveDirection> result;
  for (const WaveDirection& w : waves) result.push_back(-w);
  return result;
}

// y <- y + U C V^T x
void add_low_rank(std::size_t n, const std::vector<Complex>& u, const std::vector<Complex>& c,
                  const std::vector<Complex>& v, std::span<const Complex> x, std::span<Complex> y) {
  const std::size_t rank = u.size() / n, columns = x.size() / n;
  if (rank == 0 || columns == 0) return;
  const auto received = transposed_product(v, x.data(), columns, n);  // [column][wave]
  std::vector<Complex> coupled(rank * columns);
  multiply(CblasNoTrans, CblasNoTrans, rank, columns, rank, 1, c.data(), rank, received.data(),
           rank, 0, coupled.data(), rank);
  multiply(CblasNoTrans, CblasNoTrans, n, columns, rank, 1, u.data(), n, coupled.data(), rank, 1,
           y.data(), n);
}

// Replaces X by A^-1 X. A is a column-major matrix of size n.
void solve_small(std::vector<Complex> a, std::size_t n, std::vector<Complex>& x) {
  std::vector<lapack_int> pivots(n);
  const auto size = static_cast<lapack_int>(n);
  LAPACKE_zgesv(LAPACK_COL_MAJOR, size, static_cast<lapack_int>(x.size() / n), a.data(), size,
                pivots.data(), x.data(), size);
}

}  // namespace

std::vector<CellChannel> channels_of(double k, const Period& period) {
  const double step = 2 * std::numbers::pi / (k * period.width),
               first = period.phase / (k * period.width);
  std::vector<CellChannel> channels;
  for (int m = static_cast<int>(std::floor((-1 - first) / step)); m * step + first < 1; ++m) {
    const double sine = (2 * std::numbers::pi * m + period.phase) / (k * period.width);
    const double square = (1 - sine) * (1 + sine);
    if (square > 0) channels.push_back({m, sine, std::sqrt(square)});
  }
  return channels;
}

// Takes as many near copies as needed so that the others are no nearer than the region is deep.
CellImages cell_images(double k, const Period& period, const Rectangle& region, double tolerance) {
  CellImages images{period, {period.width, period.phase, 1}, {}};
  while (image_distance(images.near, region) < std::max(region.depth(), 0.5 * period.width))
    ++images.near.count;
  images.waves.push_back(image_waves(k, images.near, region, tolerance));
  if (images.near.symmetric()) return images;
  Copies opposite = images.near;
  opposite.phase = -opposite.phase;
  images.waves.push_back(image_waves(k, opposite, region, tolerance));
  return images;
}

PeriodicCell::PeriodicCell(const Placement& placement, double k, const CellImages& images,
                           double tolerance, std::span<const Vec> sensors)
    : images_(images),
      near_(checked(placement, images.period), k, tolerance, sensors, 1, images.near) {}

std::vector<std::size_t> PeriodicCell::all_unknowns() const {
  std::vector<std::size_t> all(unknowns());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

PeriodicCell::Far PeriodicCell::far(std::span<const std::size_t> unknowns) const {
  Far far;
  for (const ImageWaves& waves : images_.waves) {
    far.towards.push_back(near_.plane_waves(waves.w, waves.right, unknowns));
    far.away.push_back(near_.plane_waves(reversed(waves.w), waves.left, unknowns));
  }
  return far;
}

void PeriodicCell::add_far(std::span<const std::size_t> unknowns, Complex* matrix) const {
  const std::size_t n = unknowns.size();
  const Far far = this->far(unknowns);
  const auto add = [&](const auto& received, const auto& sent, const auto& coupling) {
    const std::size_t rank = received.size() / n;
    std::vector<Complex> coupled(n * rank);
    multiply(CblasNoTrans, CblasNoTrans, n, rank, rank, 1, received.data(), n, coupling.data(),
             rank, 0, coupled.data(), n);
    multiply(CblasNoTrans, CblasTrans, n, n, rank, 1, coupled.data(), n, sent.data(), n, 1, matrix,
             n);
  };
  add(far.towards.front(), far.away.front(), images_.waves.front().coupling);
  add(far.away.back(), far.towards.back(), images_.waves.back().coupling);
}

Entries PeriodicCell::matrix() const {
  Entries matrix = near_.matrix();
  add_far(all_unknowns(), matrix.data());
  return matrix;
}

// Sums over the near copies as over additional scatterers.
BlockMap PeriodicCell::product(const std::shared_ptr<const TMatrixSystem>& all,
                               double tolerance) const {
  const Copies& copies = near_.copies();
  const auto fast = std::make_shared<const FastProduct>(*all, tolerance);
  const auto far = std::make_shared<const Far>(this->far(all_unknowns()));
  return [this, all, fast, far, copies](std::span<const Complex> x) {
    const std::size_t n = unknowns();
    std::vector<Complex> repeated;
    for (std::size_t column = 0; column < x.size(); column += n) {
      const auto own = x.subspan(column, n);
      repeated.insert(repeated.end(), own.begin(), own.end());
      for (int m = 1; m <= copies.count; ++m)
        for (const int side : {-m, m})
          for (const Complex value : own) repeated.push_back(copies.factor(side) * value);
    }
    const auto sums = (*fast)(repeated);
    std::vector<Complex> y;
    for (std::size_t column = 0; column < x.size() / n; ++column) {
      const auto first = sums.begin() + static_cast<std::ptrdiff_t>(column * all->unknowns());
      y.insert(y.end(), first, first + static_cast<std::ptrdiff_t>(n));
    }
    const auto& waves = images_.waves;
    add_low_rank(n, far->towards.front(), waves.front().coupling, far->away.front(), x, y);
    add_low_rank(n, far->away.back(), waves.back().coupling, far->towards.back(), x, y);
    return y;
  };
}

// The coupling to copies is the difference of the entries of M_near and those without copies.
FastDirect PeriodicCell::factored(const TMatrixSystem& all, double tolerance, bool solves) const {
  FastDirect::Options options{.copies = 2 * static_cast<std::size_t>(near_.copies().count),
                              .solves = solves};
  options.coupling = [&](std::span<const std::size_t> unknowns, std::vector<Complex>& matrix) {
    const std::size_t n = unknowns.size();
    std::vector<Complex> part(n * n);
    near_.entries(unknowns, unknowns, part.data(), n);
    for (std::size_t i = 0; i < part.size(); ++i) matrix[i] += part[i];
    all.entries(unknowns, unknowns, part.data(), n);
    for (std::size_t i = 0; i < part.size(); ++i) matrix[i] -= part[i];
    add_far(unknowns, matrix.data());
  };
  return {all, tolerance, options};
}

SolvableEquations PeriodicCell::equations() const {
  const auto all = std::make_shared<const TMatrixSystem>(near_.with_explicit_copies());
  // There are many right-hand sides. It is cheaper to factor more accurately than to refine them.
  constexpr double finer = 0.03;
  return {unknowns(), symmetric(), [this] { return matrix(); },
          [this, all](double tolerance) { return product(all, tolerance); },
          [this, all](double tolerance) -> BlockMap {
            const auto factor =
                std::make_shared<const FastDirect>(factored(*all, finer * tolerance, true));
            return [factor](std::span<const Complex> x) {
              std::vector<Complex> y(x.begin(), x.end());
              factor->solve(y);
              return y;
            };
          }};
}

PeriodicCell::Solver PeriodicCell::reduced(double tolerance) const {
  const auto factor =
      std::make_shared<const FastDirect>(factored(near_.with_explicit_copies(), tolerance, false));
  const auto unknowns = factor->root_unknowns();
  return {{unknowns.begin(), unknowns.end()}, [factor](std::span<const Complex> x) {
            std::vector<Complex> y(x.begin(), x.end());
            factor->solve_root(y);
            return y;
          }};
}

PeriodicCell::Solver PeriodicCell::whole(EquationSolver& solver) const {
  return {all_unknowns(), [&solver](std::span<const Complex> x) {
            return solver.solve({x.begin(), x.end()});
          }};
}

// With the grazing channels the matrix is M + U D^-1 V^T, where D is proportional to their k_z. Its
// solution is X - M^-1 U (D + V^T M^-1 U)^-1 V^T X with X = M^-1 rhs.
PeriodicCell::Solution PeriodicCell::solve(const Solver& solver, std::vector<Complex> rhs) const {
  const std::size_t n = solver.unknowns.size(), size = rhs.size();
  std::vector<Complex> v, d;
  for (std::size_t side = 0; side < 2; ++side) {
    const ImageWaves& waves = side == 0 ? images_.waves.front() : images_.waves.back();
    if (!waves.grazing) continue;
    const auto [w, coupling, grazing] = *waves.grazing;
    const auto towards = near_.plane_waves(std::vector{w}, waves.right, solver.unknowns),
               away = near_.plane_waves(std::vector{-w}, waves.left, solver.unknowns);
    append(rhs, side == 0 ? towards : away);
    append(v, side == 0 ? away : towards);
    d.push_back(grazing / coupling);
  }
  auto x = solver.solve(rhs);
  const std::size_t extra = d.size(), columns = size / n;
  if (extra == 0) return {std::move(x), {}};
  const std::vector<Complex> response(x.begin() + static_cast<std::ptrdiff_t>(size), x.end());
  x.resize(size);
  auto inner = transposed_product(v, response.data(), extra, n);
  for (std::size_t i = 0; i < extra; ++i) inner[i * (extra + 1)] += d[i];
  auto sums = transposed_product(v, x.data(), columns, n);
  solve_small(std::move(inner), extra, sums);
  multiply(CblasNoTrans, CblasNoTrans, n, columns, extra, -1, response.data(), n, sums.data(),
           extra, 1, x.data(), n);
  return {std::move(x), std::move(sums)};
}

std::vector<Complex> PeriodicCell::right_hand_side(std::span<const PlaneWave> waves) const {
  std::vector<Complex> rhs(unknowns());
  for (const PlaneWave& wave : waves) {
    const auto part = near_.plane_waves(std::vector{wave.w}, wave.origin);
    for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] -= wave.amplitude * part[i];
  }
  return rhs;
}

std::vector<PlaneWave> PeriodicCell::image_field(const Solution& solution,
                                                 std::size_t column) const {
  const std::size_t n = unknowns();
  const Complex* const x = &solution.x[n * column];
  const std::size_t extra = solution.grazing.size() * n / solution.x.size();
  std::size_t grazing = extra * column;
  std::vector<PlaneWave> field;
  for (const bool from_right : {true, false}) {
    const ImageWaves& waves = from_right ? images_.waves.front() : images_.waves.back();
    const std::size_t rank = waves.w.size();
    const Vec origin = from_right ? waves.right : waves.left;
    const auto sent = from_right ? near_.plane_waves(reversed(waves.w), waves.left)
                                 : near_.plane_waves(waves.w, waves.right);
    const auto received = transposed_product(sent, x, 1, n);
    std::vector<Complex> amplitudes(rank);
    multiply(CblasNoTrans, CblasNoTrans, rank, 1, rank, 1, waves.coupling.data(), rank,
             received.data(), rank, 0, amplitudes.data(), rank);
    const auto add = [&](const WaveDirection& w, Complex amplitude) {
      field.push_back({from_right ? w : -w, amplitude, origin});
    };
    for (std::size_t i = 0; i < rank; ++i) add(waves.w[i], amplitudes[i]);
    if (waves.grazing) add(waves.grazing->w, solution.grazing[grazing++]);
  }
  return field;
}

std::vector<Complex> PeriodicCell::right_hand_sides(std::span<const WaveDirection> waves,
                                                    std::span<const std::size_t> unknowns) const {
  auto rhs = near_.plane_waves(waves, {}, unknowns);
  for (Complex& value : rhs) value = -value;
  return rhs;
}

std::vector<Complex> PeriodicCell::outgoing_rows(std::span<const WaveDirection> waves,
                                                 std::span<const std::size_t> unknowns) const {
  auto rows = near_.plane_waves(reversed({waves.begin(), waves.end()}), {}, unknowns);
  for (Complex& value : rows) value *= 2 / period().width;
  return rows;
}

}  // namespace flatspeckle::wave

#include "wave_solver/periodic/periodic_cell.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/skeletons/fast_direct.h"
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
                           double tolerance)
    : images_(images), near_(checked(placement, images.period), k, tolerance, {}, 1, images.near) {
  for (const ImageWaves& waves : images.waves) {
    towards_.push_back(near_.plane_waves(waves.w, waves.right));
    away_.push_back(near_.plane_waves(reversed(waves.w), waves.left));
  }
}

std::vector<PeriodicCell::Far> PeriodicCell::far() const {
  return {{&towards_.front(), &away_.front(), &images_.waves.front().coupling},
          {&away_.back(), &towards_.back(), &images_.waves.back().coupling}};
}

void PeriodicCell::add_far(std::span<const Complex> x, std::span<Complex> y) const {
  for (const Far& part : far())
    add_low_rank(unknowns(), *part.received, *part.coupling, *part.sent, x, y);
}

Entries PeriodicCell::matrix() const {
  const std::size_t n = unknowns();
  Entries matrix = near_.matrix();
  for (const Far& part : far()) {
    const std::size_t rank = part.received->size() / n;
    std::vector<Complex> coupled(n * rank);
    multiply(CblasNoTrans, CblasNoTrans, n, rank, rank, 1, part.received->data(), n,
             part.coupling->data(), rank, 0, coupled.data(), n);
    multiply(CblasNoTrans, CblasTrans, n, n, rank, 1, coupled.data(), n, part.sent->data(), n, 1,
             matrix.data(), n);
  }
  return matrix;
}

// Sums over the near copies as over additional scatterers.
BlockMap PeriodicCell::product(double tolerance) const {
  const Copies& copies = near_.copies();
  const auto all = std::make_shared<const TMatrixSystem>(near_.with_explicit_copies());
  const auto fast = std::make_shared<const FastProduct>(*all, tolerance);
  return [this, all, fast, copies](std::span<const Complex> x) {
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
    add_far(x, y);
    return y;
  };
}

// Applies M^-1 = A - A P (1 + K P^T A P)^-1 K P^T A with A = M_near^-1, P = (U, V) and K = (0, C;
// C, 0).
BlockMap PeriodicCell::inverse(double tolerance) const {
  const std::size_t n = unknowns(), rank = towards_.front().size() / n;
  const auto factor = std::make_shared<const FastDirect>(near_, tolerance);
  std::vector<Complex> p = towards_.front();
  append(p, away_.front());
  const auto response = std::make_shared<std::vector<Complex>>(p);
  factor->solve(*response);
  const auto couple = [this, rank](const std::vector<Complex>& sums) {  // K times columns
    const std::size_t columns = sums.size() / (2 * rank);
    std::vector<Complex> result(sums.size());
    for (const std::size_t half : {std::size_t{0}, rank})
      multiply(CblasNoTrans, CblasNoTrans, rank, columns, rank, 1,
               images_.waves.front().coupling.data(), rank, &sums[rank - half], 2 * rank, 0,
               &result[half], 2 * rank);
    return result;
  };
  auto inner = couple(transposed_product(p, response->data(), 2 * rank, n));
  for (std::size_t i = 0; i < 2 * rank; ++i) inner[i * (2 * rank + 1)] += 1;
  return [n, rank, factor, response, couple, p = std::move(p),
          inner = std::move(inner)](std::span<const Complex> x) {
    std::vector<Complex> y(x.begin(), x.end());
    factor->solve(y);
    auto sums = couple(transposed_product(p, y.data(), y.size() / n, n));
    solve_small(inner, 2 * rank, sums);
    multiply(CblasNoTrans, CblasNoTrans, n, y.size() / n, 2 * rank, -1, response->data(), n,
             sums.data(), 2 * rank, 1, y.data(), n);
    return y;
  };
}

SolvableEquations PeriodicCell::equations() const {
  SolvableEquations equations{unknowns(), symmetric(), [this] { return matrix(); },
                              [this](double tolerance) { return product(tolerance); }};
  // There are many right-hand sides. It is cheaper to factor more accurately than to refine them.
  constexpr double finer = 0.03;
  if (symmetric() && unknowns() > 0)
    equations.inverse = [this](double tolerance) { return inverse(finer * tolerance); };
  return equations;
}

// With the grazing channels the matrix is M + U D^-1 V^T, where D is proportional to their k_z. Its
// solution is X - M^-1 U (D + V^T M^-1 U)^-1 V^T X with X = M^-1 rhs.
std::vector<Complex> PeriodicCell::solve(EquationSolver& solver, std::vector<Complex> rhs) const {
  const std::size_t n = unknowns(), size = rhs.size();
  std::vector<Complex> v, d;
  for (std::size_t side = 0; side < 2; ++side) {
    const ImageWaves& waves = side == 0 ? images_.waves.front() : images_.waves.back();
    if (!waves.grazing) continue;
    const auto [w, coupling, grazing] = *waves.grazing;
    const auto towards = near_.plane_waves(std::vector{w}, waves.right),
               away = near_.plane_waves(std::vector{-w}, waves.left);
    append(rhs, side == 0 ? towards : away);
    append(v, side == 0 ? away : towards);
    d.push_back(grazing / coupling);
  }
  auto x = solver.solve(rhs);
  const std::size_t extra = d.size(), columns = size / n;
  if (extra == 0) return x;
  const std::vector<Complex> response(x.begin() + static_cast<std::ptrdiff_t>(size), x.end());
  x.resize(size);
  auto inner = transposed_product(v, response.data(), extra, n);
  for (std::size_t i = 0; i < extra; ++i) inner[i * (extra + 1)] += d[i];
  auto sums = transposed_product(v, x.data(), columns, n);
  solve_small(std::move(inner), extra, sums);
  multiply(CblasNoTrans, CblasNoTrans, n, columns, extra, -1, response.data(), n, sums.data(),
           extra, 1, x.data(), n);
  return x;
}

std::vector<Complex> PeriodicCell::right_hand_sides(std::span<const WaveDirection> waves) const {
  auto rhs = near_.plane_waves(waves);
  for (Complex& value : rhs) value = -value;
  return rhs;
}

std::vector<Complex> PeriodicCell::outgoing_rows(std::span<const WaveDirection> waves) const {
  auto rows = near_.plane_waves(reversed({waves.begin(), waves.end()}));
  for (Complex& value : rows) value *= 2 / period().width;
  return rows;
}

}  // namespace flatspeckle::wave

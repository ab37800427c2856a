#include "wave_solver/skeletons/fast_direct.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <omp.h>

#include "core/contract.h"
#include "core/error.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "core/run/stopwatch.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/wave_equations.h"
#include "wave_solver/skeletons/interpolative.h"

namespace flatspeckle::wave {

namespace {

std::vector<Complex> submatrix(const std::vector<Complex>& m, std::size_t n,
                               const std::vector<std::size_t>& rows,
                               const std::vector<std::size_t>& columns) {
  std::vector<Complex> part;
  part.reserve(rows.size() * columns.size());
  for (std::size_t j : columns)
    for (std::size_t i : rows) part.push_back(m[i + n * j]);
  return part;
}

std::vector<std::size_t> chosen(const std::vector<std::size_t>& from,
                                const std::vector<std::size_t>& places) {
  std::vector<std::size_t> values;
  values.reserve(places.size());
  for (std::size_t place : places) values.push_back(from[place]);
  return values;
}

// Copies the rows of X that belong to some unknowns into a block. scatter() copies them back.
std::vector<Complex> gather(const Complex* x, const std::vector<std::size_t>& unknowns,
                            std::size_t columns) {
  std::vector<Complex> part(unknowns.size() * columns);
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    std::copy_n(x + unknowns[i] * columns, columns, &part[i * columns]);
  return part;
}

void scatter(const std::vector<Complex>& part, const std::vector<std::size_t>& unknowns,
             std::size_t columns, Complex* x) {
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    std::copy_n(&part[i * columns], columns, x + unknowns[i] * columns);
}

// C <- old C + factor A B, or old C + factor A B^T, with complex A, real B and the factors `old`
// and `factor`. BLAS receives A as a real matrix with twice the rows.
void add_product(CBLAS_TRANSPOSE transpose, std::size_t rows, std::size_t columns,
                 std::size_t inner, double factor, const std::vector<Complex>& a,
                 const std::vector<double>& b, double old, std::vector<Complex>& c) {
  cblas_dgemm(CblasColMajor, CblasNoTrans, transpose, blas_size(2 * rows), blas_size(columns),
              blas_size(inner), factor, reinterpret_cast<const double*>(a.data()),
              blas_size(2 * rows), b.data(), blas_size(transpose == CblasTrans ? columns : inner),
              old, reinterpret_cast<double*>(c.data()), blas_size(2 * rows));
}

// C <- C - A B, or C - A B^T
void subtract_product(CBLAS_TRANSPOSE transpose, std::size_t rows, std::size_t columns,
                      std::size_t inner, const std::vector<Complex>& a,
                      const std::vector<Complex>& b, std::size_t ldb, std::vector<Complex>& c) {
  multiply(CblasNoTrans, transpose, rows, columns, inner, -1, a.data(), rows, b.data(), ldb, 1,
           c.data(), rows);
}

// X <- X L^-T (transpose = CblasTrans), or X L^-1
void divide(CBLAS_TRANSPOSE transpose, std::size_t rows, std::size_t n,
            const std::vector<Complex>& l, std::vector<Complex>& x) {
  triangular_solve(CblasRight, CblasLower, transpose, rows, n, l.data(), n, x.data(), rows);
}

constexpr std::size_t leaf_unknowns = 256;  // smaller boxes would hardly be compressed

std::vector<SortedDisk> disks_of(const WaveEquations& system) {
  std::vector<SortedDisk> disks;
  for (std::size_t j = 0; j < system.bodies().size(); ++j)
    disks.push_back({system.bodies()[j].centre, system.bodies()[j].radius,
                     system.first(j + 1) - system.first(j)});
  return disks;
}

double square(std::size_t n) {
  return static_cast<double>(n) * static_cast<double>(n);
}

}  // namespace

SkeletonElimination::SkeletonElimination(const std::vector<std::size_t>& unknowns,
                                         const std::vector<Complex>& m,
                                         const Interpolation& interpolation)
    : skeleton_(chosen(unknowns, interpolation.skeleton)),
      redundant_(chosen(unknowns, interpolation.redundant)),
      t_(interpolation.t),
      e_(submatrix(m, unknowns.size(), interpolation.skeleton, interpolation.redundant)),
      l_(submatrix(m, unknowns.size(), interpolation.redundant, interpolation.redundant)),
      schur_complement_(
          submatrix(m, unknowns.size(), interpolation.skeleton, interpolation.skeleton)) {
  const std::size_t s = skeleton_.size(), r = redundant_.size();
  if (r == 0) return;
  if (s > 0) congruence();
  if (!factor_symmetric(l_.data(), r, r))
    throw std::runtime_error("the multiple-scattering equations of a box are singular");
  if (s == 0) return;
  divide(CblasTrans, s, r, l_, e_);
  subtract_square(s, r, e_.data(), schur_complement_.data(), s);
  mirror_lower(schur_complement_, s);
}

// Replaces M_SR in e_ by Q, and the lower triangle of M_RR in l_ by the lower triangle of X_RR
// (symbols: SkeletonElimination). M_SS is in schur_complement_. X_RR is computed as
// M_RR - P T - (P T)^T, with P^T = M_SR - M_SS T / 2.
void SkeletonElimination::congruence() {
  const std::size_t s = skeleton_.size(), r = redundant_.size();
  std::vector<Complex> half(s * r), p(r * s), p_t(r * r);
  add_product(CblasTrans, s, r, s, 0.5, schur_complement_, t_, 0, half);
  for_each_tiled(
      r, s, [&](std::size_t i, std::size_t j) { p[i + r * j] = e_[j + s * i] - half[j + s * i]; });
  for (std::size_t i = 0; i < e_.size(); ++i) e_[i] -= 2.0 * half[i];
  add_product(CblasTrans, r, r, s, 1, p, t_, 0, p_t);
  for_each_tiled(r, r, [&](std::size_t i, std::size_t j) {
    if (i >= j) l_[i + r * j] -= p_t[i + r * j] + p_t[j + r * i];
  });
}

void SkeletonElimination::forget() {
  redundant_ = {};
  t_ = {};
  e_ = l_ = {};
}

double SkeletonElimination::bytes() const {
  return static_cast<double>(sizeof(double) * t_.size() +
                             sizeof(Complex) * (e_.size() + l_.size()) +
                             sizeof(std::size_t) * (skeleton_.size() + redundant_.size()));
}

// b_R <- L^-1 (b_R - T^T b_S), b_S <- b_S - E b_R. In gathered blocks the columns of X are rows.
void SkeletonElimination::forward(Complex* x, std::size_t columns) const {
  const std::size_t s = skeleton_.size(), r = redundant_.size();
  if (r == 0) return;
  auto x_s = gather(x, skeleton_, columns), x_r = gather(x, redundant_, columns);
  if (s > 0) add_product(CblasTrans, columns, r, s, -1, x_s, t_, 1, x_r);
  divide(CblasTrans, columns, r, l_, x_r);
  if (s > 0) subtract_product(CblasTrans, columns, s, r, x_r, e_, s, x_s);
  scatter(x_s, skeleton_, columns, x);
  scatter(x_r, redundant_, columns, x);
}

// x_R <- L^-T (x_R - E^T x_S), x_S <- x_S - T x_R
void SkeletonElimination::backward(Complex* x, std::size_t columns) const {
  const std::size_t s = skeleton_.size(), r = redundant_.size();
  if (r == 0) return;
  auto x_s = gather(x, skeleton_, columns), x_r = gather(x, redundant_, columns);
  if (s > 0) subtract_product(CblasNoTrans, columns, r, s, x_s, e_, s, x_r);
  divide(CblasNoTrans, columns, r, l_, x_r);
  if (s > 0) add_product(CblasNoTrans, columns, s, r, -1, x_r, t_, 1, x_s);
  scatter(x_s, skeleton_, columns, x);
  scatter(x_r, redundant_, columns, x);
}

// Builds the factors from the leaves upwards. active_: unknowns of each box that are not
// eliminated. Before the box is processed they are all unknowns of a leaf, or the skeletons of both
// halves of another box; afterwards they are the skeleton of the box. schur_complement_: Schur
// complement of each processed box. shift_: displacements of the copies, and 0.
class FastDirect::Builder {
 public:
  Builder(const WaveEquations& system, double tolerance, const Options& options)
      : system_(system),
        options_(options),
        skeletonization_(system, tolerance),
        disks_(disks_of(system)),
        own_(disks_.size() / (options.copies + 1)),
        tree_(std::span(disks_).first(own_), leaf_unknowns),
        active_(tree_.boxes().size()),
        schur_complement_(tree_.boxes().size()),
        cpu_seconds_(tree_.boxes().size()) {
    for (std::size_t box = 0; box < active_.size(); ++box)
      if (tree_.boxes()[box].is_leaf()) active_[box] = own_unknowns(box);
    for (std::size_t copy = 0; own_ > 0 && copy <= options.copies; ++copy)
      shift_.push_back(disks_[copy * own_].centre - disks_[0].centre);
  }

  void build(FastDirect& result) {
    for (std::size_t level = tree_.levels(); level-- > 1;) {
      result.levels_.push_back(eliminate_level(level, result.statistics_.bytes));
      summarize(level, result);
    }
    if (tree_.levels() > 0) factor_root(result);
    for (double seconds : cpu_seconds_) result.statistics_.cpu_seconds += seconds;
  }

 private:
  std::vector<std::size_t> own_unknowns(std::size_t box) const {
    std::vector<std::size_t> unknowns;
    for (std::size_t place = tree_.boxes()[box].first; place < tree_.boxes()[box].last; ++place) {
      const std::size_t disk = tree_.order()[place];
      for (std::size_t u = system_.first(disk); u < system_.first(disk + 1); ++u)
        unknowns.push_back(u);
    }
    return unknowns;
  }

  void connect_halves(std::size_t level) {
    for (std::size_t box = tree_.level_begin(level); box < tree_.level_end(level); ++box) {
      if (tree_.boxes()[box].is_leaf()) continue;
      for (std::size_t half : {tree_.boxes()[box].child, tree_.boxes()[box].child + 1})
        active_[box].insert(active_[box].end(), active_[half].begin(), active_[half].end());
    }
  }

  // A box with n unknowns stores at most 16 n^2 bytes, including its Schur complement; the maximum
  // is reached if all its unknowns are eliminated. During elimination it needs three times as much.
  void require_memory(std::size_t level, double held) const {
    double bytes = held, largest = 0;
    for (std::size_t box = tree_.level_begin(level); box < tree_.level_end(level); ++box) {
      const double block = sizeof(Complex) * square(active_[box].size());
      bytes += block;
      largest = std::max(largest, block);
    }
    bytes += 3 * largest * omp_get_max_threads();
    if (bytes <= options_.memory) return;
    throw InputError(
        "unknowns", system_.unknowns(),
        "the fast direct solver may need " + std::to_string(static_cast<long long>(bytes)) +
            " bytes; available bytes: " + std::to_string(static_cast<long long>(options_.memory)) +
            "; use fewer scatterers or a larger tolerance");
  }

  // Returns the block of the remaining unknowns of a box. In a leaf it contains entries of M. In
  // other boxes it contains the Schur complements of the two halves, and entries of M between the
  // halves.
  std::vector<Complex> block(std::size_t box) {
    const std::span<const std::size_t> unknowns = active_[box];
    const std::size_t n = unknowns.size();
    std::vector<Complex> m(n * n);
    if (tree_.boxes()[box].is_leaf()) {
      constexpr std::size_t width = 64;
      for (std::size_t j = 0; j < n; j += width)
        system_.entries(unknowns.subspan(j), unknowns.subspan(j, std::min(width, n - j)),
                        &m[j * (n + 1)], n);
    } else {
      const std::size_t half = tree_.boxes()[box].child, size = active_[half].size();
      place_schur_complement(half, m, n, 0);
      place_schur_complement(half + 1, m, n, size);
      system_.entries(unknowns.subspan(size), unknowns.first(size), &m[size], n);
    }
    mirror_lower(m, n);
    return m;
  }

  void place_schur_complement(std::size_t half, std::vector<Complex>& m, std::size_t n,
                              std::size_t first) {
    const std::size_t size = active_[half].size();
    for (std::size_t j = 0; j < size; ++j)
      std::copy_n(&schur_complement_[half][j * size], size, &m[first + n * (first + j)]);
    std::vector<Complex>().swap(schur_complement_[half]);
  }

  // Returns the unknowns outside a box, those of copies included, that are not yet eliminated when
  // the box's level is processed, and that belong to disks whose rims are nearer to the box than
  // `distance`.
  std::vector<std::size_t> near_unknowns(std::size_t box, double distance) const {
    std::vector<std::size_t> found;
    for (std::size_t copy = 0; copy < shift_.size(); ++copy)
      append_near(box, distance, copy, found);
    return found;
  }

  void append_near(std::size_t box, double distance, std::size_t copy,
                   std::vector<std::size_t>& found) const {
    const auto& boxes = tree_.boxes();
    const Vec shift = shift_[copy];
    const Rectangle hull{boxes[box].hull.low - shift, boxes[box].hull.high - shift};
    std::vector<std::size_t> open{0};
    while (!open.empty()) {
      const std::size_t other = open.back();
      open.pop_back();
      if ((other == box && copy == 0) || hull.distance(boxes[other].hull) >= distance) continue;
      if (boxes[other].level < boxes[box].level && !boxes[other].is_leaf()) {
        open.push_back(boxes[other].child);
        open.push_back(boxes[other].child + 1);
        continue;
      }
      for (std::size_t unknown : active_[other]) {
        const SortedDisk& disk = disks_[system_.body_of(unknown)];
        if (hull.distance(disk.centre) - disk.radius < distance)
          found.push_back(unknown + system_.first(copy * own_));
      }
    }
  }

  SkeletonElimination eliminate(std::size_t box) {
    stop_if_interrupted();
    const double start = thread_cpu_seconds();
    const ActiveBox active{tree_.boxes()[box].hull, active_[box]};
    const auto near = near_unknowns(box, skeletonization_.distance(active));
    // The random stream depends on the box, not on the thread.
    const auto interpolation = skeletonization_(active, near, RandomStream(0, 0, box));
    SkeletonElimination elimination(active_[box], block(box), interpolation);
    schur_complement_[box] = elimination.take_schur_complement();
    if (!options_.solves) elimination.forget();
    cpu_seconds_[box] = thread_cpu_seconds() - start;
    return elimination;
  }

  std::vector<SkeletonElimination> eliminate_level(std::size_t level, double held) {
    connect_halves(level);
    require_memory(level, held);
    const std::size_t begin = tree_.level_begin(level);
    std::vector<SkeletonElimination> eliminations(tree_.level_end(level) - begin);
    parallel_for(eliminations.size(),
                 [&](std::size_t i) { eliminations[i] = eliminate(begin + i); });
    return eliminations;
  }

  void summarize(std::size_t level, FastDirect& result) {
    const std::size_t begin = tree_.level_begin(level);
    Level summary;
    for (const auto& elimination : result.levels_.back()) {
      auto& active = active_[begin + summary.boxes++];
      summary.unknowns += active.size();
      active = elimination.skeleton();
      summary.skeleton += active.size();
      summary.largest = std::max(summary.largest, active.size());
      result.statistics_.bytes += elimination.bytes();
    }
    result.statistics_.levels.push_back(summary);
  }

  void factor_root(FastDirect& result) {
    connect_halves(0);
    require_memory(0, result.statistics_.bytes);
    const double start = thread_cpu_seconds();
    const std::size_t n = active_[0].size();
    result.root_ = block(0);
    result.root_unknowns_ = active_[0];
    result.factor_root(options_.coupling);
    result.statistics_.root = n;
    result.statistics_.bytes += sizeof(Complex) * square(n);
    cpu_seconds_[0] = thread_cpu_seconds() - start;
  }

  const WaveEquations& system_;
  const Options& options_;
  Skeletonization skeletonization_;
  std::vector<SortedDisk> disks_;
  std::size_t own_;  // number of disks that are not copies
  BoxTree tree_;
  std::vector<Vec> shift_;
  std::vector<std::vector<std::size_t>> active_;
  std::vector<std::vector<Complex>> schur_complement_;
  std::vector<double> cpu_seconds_;
};

FastDirect::FastDirect(const WaveEquations& system, double tolerance, const Options& options)
    : unknowns_(system.unknowns() / (options.copies + 1)), solves_(options.solves) {
  FS_EXPECT(tolerance > 0 && tolerance < 1);
  blas_single_thread();
  const Stopwatch watch;
  Builder(system, tolerance, options).build(*this);
  statistics_.wall_seconds = watch.seconds();
}

void FastDirect::factor_root(const RootCoupling& coupling) {
  const std::size_t n = root_unknowns_.size();
  bool factored = false;
  if (coupling) {
    coupling(root_unknowns_, root_);
    pivots_.resize(n);
    factored = LAPACKE_zgetrf(LAPACK_COL_MAJOR, blas_size(n), blas_size(n), root_.data(),
                              blas_size(n), pivots_.data()) == 0;
  } else {
    factored = factor_symmetric(root_.data(), n, n);
  }
  if (!factored)
    throw std::runtime_error("the multiple-scattering equations are singular or not finite");
}

void FastDirect::solve(std::span<Complex> x) const {
  FS_EXPECT(solves_);
  if (unknowns_ == 0) return;
  constexpr std::size_t most = 64;  // columns that are solved at once
  for (std::size_t first = 0; first < x.size(); first += most * unknowns_) {
    const auto part = x.subspan(first, std::min(most * unknowns_, x.size() - first));
    const std::size_t columns = part.size() / unknowns_;
    std::vector<Complex> turned(part.size());  // [unknown][column]
    for_each_tiled(unknowns_, columns, [&](std::size_t i, std::size_t column) {
      turned[i * columns + column] = part[column * unknowns_ + i];
    });
    for (const auto& level : levels_)
      parallel_for(level.size(), [&](std::size_t i) { level[i].forward(turned.data(), columns); });
    solve_root_of(turned, columns);
    for (auto level = levels_.rbegin(); level != levels_.rend(); ++level)
      parallel_for(level->size(),
                   [&](std::size_t i) { (*level)[i].backward(turned.data(), columns); });
    for_each_tiled(unknowns_, columns, [&](std::size_t i, std::size_t column) {
      part[column * unknowns_ + i] = turned[i * columns + column];
    });
  }
}

void FastDirect::solve_root(std::span<Complex> x) const {
  const std::size_t n = root_unknowns_.size(), columns = n == 0 ? 0 : x.size() / n;
  if (columns == 0) return;
  if (pivots_.empty()) {
    solve_forward(root_.data(), n, n, x.data(), columns, n);
    solve_backward(root_.data(), n, n, x.data(), columns, n);
  } else {
    LAPACKE_zgetrs(LAPACK_COL_MAJOR, 'N', blas_size(n), blas_size(columns), root_.data(),
                   blas_size(n), pivots_.data(), x.data(), blas_size(n));
  }
}

void FastDirect::solve_root_of(std::vector<Complex>& x, std::size_t columns) const {
  const std::size_t n = root_unknowns_.size();
  std::vector<Complex> part(n * columns);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t column = 0; column < columns; ++column)
      part[i + n * column] = x[root_unknowns_[i] * columns + column];
  solve_root(part);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t column = 0; column < columns; ++column)
      x[root_unknowns_[i] * columns + column] = part[i + n * column];
}

}  // namespace flatspeckle::wave

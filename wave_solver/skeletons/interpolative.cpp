#include "wave_solver/skeletons/interpolative.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

namespace {

// Samples that are eliminated together; those that at least are looked at to tell the error, since
// each of them knows of some of the rows only.
constexpr std::size_t sample_window = 64;

std::size_t panel_of(std::size_t columns) {
  return columns < 400 ? 8 : 16;
}

// LU of the transposed sketch, n rows (the columns of A) by samples; pivots take their order.
class PivotedLu {
 public:
  PivotedLu(std::vector<double> a, std::size_t n) : a_(std::move(a)), n_(n), order_(n) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  std::size_t rank() const { return pivots_.size(); }
  std::size_t samples() const { return a_.size() / n_; }

  // Applies the pivots since number `from` to samples first .. last - 1.
  void update(std::size_t from, std::size_t first, std::size_t last) {
    const std::size_t depth = rank() - from, width = last - first;
    if (depth == 0 || width == 0) return;
    double* const block = &a_[first * n_];
    LAPACKE_dlaswp(LAPACK_COL_MAJOR, blas_size(width), block, blas_size(n_), blas_size(from + 1),
                   blas_size(rank()), pivots_.data(), 1);
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasUnit, blas_size(depth),
                blas_size(width), 1, &a_[from * (n_ + 1)], blas_size(n_), block + from,
                blas_size(n_));
    if (rank() == n_) return;
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, blas_size(n_ - rank()), blas_size(width),
                blas_size(depth), -1, &a_[rank() + n_ * from], blas_size(n_), block + from,
                blas_size(n_), 1, block + rank(), blas_size(n_));
  }

  // What is left of a column in the next samples, mean square, the largest of all columns.
  double largest_left(std::size_t width) const {
    std::vector<double> squares(n_ - rank());
    for (std::size_t j = 0; j < width; ++j) {
      const double* const left = &a_[rank() + n_ * (rank() + j)];
      for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += left[i] * left[i];
    }
    return *std::max_element(squares.begin(), squares.end()) / static_cast<double>(width);
  }

  // The next samples, up to date, choose a pivot each.
  void eliminate(std::size_t width) {
    const std::size_t from = rank();
    pivots_.resize(from + std::min(width, n_ - from));
    LAPACKE_dgetrf(LAPACK_COL_MAJOR, blas_size(n_ - from), blas_size(rank() - from),
                   &a_[from * (n_ + 1)], blas_size(n_), &pivots_[from]);
    for (std::size_t i = from; i < rank(); ++i) {
      pivots_[i] += blas_size(from);
      std::swap(order_[i], order_[pivots_[i] - 1]);
    }
    if (from > 0)
      LAPACKE_dlaswp(LAPACK_COL_MAJOR, blas_size(from), a_.data(), blas_size(n_),
                     blas_size(from + 1), blas_size(rank()), pivots_.data(), 1);
  }

  // T^T = L_2 L_1^-1
  Interpolation interpolation() {
    const std::size_t rest = n_ - rank();
    if (rank() > 0 && rest > 0)
      cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasUnit, blas_size(rest),
                  blas_size(rank()), 1, a_.data(), blas_size(n_), &a_[rank()], blas_size(n_));
    const auto skeleton = sorted_places(0, rank()), redundant = sorted_places(rank(), n_);
    Interpolation result;
    for (std::size_t i : skeleton) result.skeleton.push_back(order_[i]);
    for (std::size_t i : redundant) result.redundant.push_back(order_[i]);
    result.t.reserve(rank() * rest);
    for (std::size_t j : skeleton)
      for (std::size_t i : redundant) result.t.push_back(a_[i + n_ * j]);
    return result;
  }

 private:
  std::vector<std::size_t> sorted_places(std::size_t first, std::size_t last) const {
    std::vector<std::size_t> places(last - first);
    std::iota(places.begin(), places.end(), first);
    std::sort(places.begin(), places.end(),
              [&](std::size_t a, std::size_t b) { return order_[a] < order_[b]; });
    return places;
  }

  std::vector<double> a_;
  std::size_t n_;
  std::vector<std::size_t> order_;
  std::vector<lapack_int> pivots_;
};

}  // namespace

RowSketch::RowSketch(std::size_t columns, RandomStream random)
    : columns_(columns),
      samples_(columns + sample_window),
      random_(random),
      sums_(columns_ * samples_),
      part_(columns) {}

void RowSketch::add(std::span<const double> row) {
  for (std::size_t i = 0; i < spread; ++i) {
    const std::uint64_t bits = random_.bits();
    const std::size_t sample = ((bits >> 32) * samples_) >> 32;
    double* const sum = &sums_[sample * columns_];
    const double sign = (bits & 1) != 0 ? 1 : -1;
    for (std::size_t j = 0; j < columns_; ++j) sum[j] += sign * row[j];
  }
}

void RowSketch::add(std::span<const Complex> row) {
  for (std::size_t j = 0; j < columns_; ++j) part_[j] = row[j].real();
  add(part_);
  for (std::size_t j = 0; j < columns_; ++j) part_[j] = row[j].imag();
  add(part_);
}

Interpolation interpolate(RowSketch sketch, double tolerance) {
  const std::size_t columns = sketch.columns_, panel = panel_of(columns);
  if (columns == 0) return {};
  // The mean square of a column over samples is spread / samples of its squared norm.
  const double limit = tolerance * tolerance * static_cast<double>(RowSketch::spread) /
                       static_cast<double>(sketch.samples_);
  PivotedLu lu(std::move(sketch.sums_), columns);
  std::size_t last = 0;  // samples that are up to date
  while (lu.rank() < columns) {
    if (lu.rank() + sample_window > last) {
      const std::size_t next = std::min(last + 2 * sample_window, lu.samples());
      lu.update(0, last, next);
      last = next;
    }
    if (lu.largest_left(last - lu.rank()) <= limit) break;
    const std::size_t from = lu.rank();
    lu.eliminate(panel);
    lu.update(from, lu.rank(), last);
  }
  return lu.interpolation();
}

}  // namespace flatspeckle::wave

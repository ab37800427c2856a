#include "wave_solver/skeletons/interpolative.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

BoxTree::BoxTree(std::span<const SortedDisk> disks, std::size_t leaf_unknowns)
    : level_{0}, order_(disks.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!disks.empty()) add(0, disks.size(), 0, disks);
  for (std::size_t box = 0; box < boxes_.size();) {
    level_.push_back(boxes_.size());
    for (; box < level_.back(); ++box) split(box, disks, leaf_unknowns);
  }
}

void BoxTree::add(std::size_t first, std::size_t last, std::size_t level,
                  std::span<const SortedDisk> disks) {
  const auto rims = [&](std::size_t place) {
    const SortedDisk& disk = disks[order_[place]];
    const Vec reach{disk.radius, disk.radius};
    return Rectangle{disk.centre - reach, disk.centre + reach};
  };
  Rectangle hull = rims(first);
  for (std::size_t place = first + 1; place < last; ++place) hull = hull.united(rims(place));
  boxes_.push_back({hull, first, last, 0, level});
}

void BoxTree::split(std::size_t box, std::span<const SortedDisk> disks, std::size_t leaf_unknowns) {
  const std::size_t first = boxes_[box].first, last = boxes_[box].last;
  const Vec one = disks[order_[first]].centre;
  Rectangle extent{one, one};
  std::size_t unknowns = 0;
  for (std::size_t place = first; place < last; ++place) {
    const SortedDisk& disk = disks[order_[place]];
    extent = extent.united({disk.centre, disk.centre});
    unknowns += disk.unknowns;
  }
  if (unknowns <= leaf_unknowns) return;

  const bool along_x = extent.width() > extent.depth();
  const Vec middle = extent.low + 0.5 * (extent.high - extent.low);
  const auto cut =
      std::stable_partition(order_.begin() + first, order_.begin() + last, [&](std::size_t disk) {
        const Vec centre = disks[disk].centre;
        return along_x ? centre.x < middle.x : centre.z < middle.z;
      });
  const auto half = static_cast<std::size_t>(cut - order_.begin());
  if (half == first || half == last) return;  // centres are equal up to rounding
  boxes_[box].child = boxes_.size();
  const std::size_t level = boxes_[box].level + 1;
  add(first, half, level, disks);
  add(half, last, level, disks);
}

namespace {

constexpr std::size_t chunk = 128;  // rows computed at a time

// Returns the largest response of a body to a unit field, which is the scale of the equations. Of
// the modes cos(n phi) and sin(n phi) only one is counted.
double largest_response(const WaveEquations& system) {
  double largest = 0;
  for (std::size_t j = 0; j < system.bodies().size(); ++j) {
    double response = system.strength(system.first(j));
    for (std::size_t unknown = system.first(j) + 1; unknown < system.first(j + 1); unknown += 2)
      response += system.strength(unknown);
    largest = std::max(largest, std::sqrt(response));
  }
  return largest;
}

// Least number of samples from which errors are estimated. A single sample is not enough, because
// it contains only some of the rows.
constexpr std::size_t sample_window = 64;

// Number of samples that are eliminated together.
std::size_t panel_of(std::size_t columns) {
  return columns < 400 ? 8 : 16;
}

// LU factorization of the transposed RowSketch of a matrix A. The rows of the factored matrix are
// the n columns of A, permuted by order_; its columns are the samples.
class PivotedLu {
 public:
  PivotedLu(std::vector<double> a, std::size_t n) : a_(std::move(a)), n_(n), order_(n) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  std::size_t rank() const { return pivots_.size(); }
  std::size_t samples() const { return a_.size() / n_; }

  // Applies the elimination steps from number `from` on to samples first .. last - 1.
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

  // Returns, for the column of A with the largest residual, the mean square of that residual over
  // the next `width` samples.
  double largest_left(std::size_t width) const {
    std::vector<double> squares(n_ - rank());
    for (std::size_t j = 0; j < width; ++j) {
      const double* const left = &a_[rank() + n_ * (rank() + j)];
      for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += left[i] * left[i];
    }
    return *std::max_element(squares.begin(), squares.end()) / static_cast<double>(width);
  }

  // Chooses one pivot in each of the next `width` samples, which must be up to date.
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

  // Returns the skeleton and T^T = L_2 L_1^-1, where L_1 are the rows of L that belong to the
  // skeleton, and L_2 the other rows.
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

std::vector<Vec> proxy_contour(const Rectangle& hull, double distance, double spacing) {
  const double quarter = distance * std::numbers::pi / 2;
  const double around = 2 * (hull.width() + hull.depth()) + 4 * quarter;
  const double step = around / std::ceil(around / spacing);
  struct Side {
    Vec end, along;
    double length;
  };
  const Side sides[] = {{{hull.high.x, hull.low.z}, {1, 0}, hull.width()},
                        {hull.high, {0, 1}, hull.depth()},
                        {{hull.low.x, hull.high.z}, {-1, 0}, hull.width()},
                        {hull.low, {0, -1}, hull.depth()}};
  std::vector<Vec> points;
  double s = step / 2;  // arc length along a side, then along the quarter circle after it
  for (const auto& [end, along, length] : sides) {
    const Vec outward{along.z, -along.x};
    for (; s < length; s += step) points.push_back(end + (s - length) * along + distance * outward);
    for (s -= length; s < quarter; s += step)
      points.push_back(
          end + distance * (std::cos(s / distance) * outward + std::sin(s / distance) * along));
    s -= quarter;
  }
  return points;
}

Skeletonization::Skeletonization(const WaveEquations& system, double tolerance)
    : system_(system),
      tolerance_(tolerance),
      logarithm_(-std::log(tolerance)),
      weight_(largest_response(system)) {}

// Evanescent waves of the box decay as exp(-q distance), where q is the wavenumber along the
// contour. On each piece of the contour that is as long as the distance, about ln(1/tolerance) / pi
// points are needed; next to it there are about density distance^2 near unknowns. The distance is
// chosen so that these two numbers are equal. The factor 1.5 was found by measurement: a larger
// distance reduces the rank by more than the additional rows cost.
double Skeletonization::distance(const ActiveBox& box) const {
  const double longer = std::max(box.hull.width(), box.hull.depth());
  const double shorter = std::min(box.hull.width(), box.hull.depth());
  const double area = longer * std::max(shorter, longer / 4);
  const double density = static_cast<double>(box.unknowns.size()) / area;
  return std::min(longer, 1.5 * std::sqrt(logarithm_ / (std::numbers::pi * density)));
}

Interpolation Skeletonization::operator()(const ActiveBox& box, std::span<const std::size_t> near,
                                          RandomStream random) const {
  if (box.unknowns.size() == 1) return {{0}, {}, {}};
  RowSketch sketch(box.unknowns.size(), random);
  add_near(box, near, sketch);
  add_contour(box, sketch);
  return interpolate(std::move(sketch), tolerance_);
}

// The rows of M of the near unknowns, restricted to the box's columns, are needed. Because M is
// symmetric, they are computed as columns of M, restricted to the box's rows.
void Skeletonization::add_near(const ActiveBox& box, std::span<const std::size_t> near,
                               RowSketch& sketch) const {
  const std::size_t n = box.unknowns.size();
  std::vector<Complex> rows(n * chunk);
  for (std::size_t first = 0; first < near.size(); first += chunk) {
    const auto part = near.subspan(first, std::min(chunk, near.size() - first));
    system_.entries(box.unknowns, part, rows.data(), n);
    for (std::size_t i = 0; i < part.size(); ++i) sketch.add(std::span(rows).subspan(n * i, n));
  }
}

// Two points per wavelength resolve all propagating waves along the contour. Evanescent waves are
// resolved up to the wavenumber q along the contour for which exp(-q distance) = sqrt(tolerance);
// waves of larger q are aliased to lower frequencies.
void Skeletonization::add_contour(const ActiveBox& box, RowSketch& sketch) const {
  const double reach = distance(box);
  const double spacing = std::numbers::pi / std::max(system_.k(), logarithm_ / (2 * reach));
  const auto points = proxy_contour(box.hull, reach, spacing);
  const std::size_t n = box.unknowns.size();
  std::vector<Complex> columns(n * chunk), row(n);
  for (std::size_t first = 0; first < points.size(); first += chunk) {
    const auto part = std::span(points).subspan(first, std::min(chunk, points.size() - first));
    system_.outgoing(part, box.unknowns, columns.data(), part.size());
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (std::size_t j = 0; j < n; ++j) row[j] = weight_ * columns[i + part.size() * j];
      sketch.add(row);
    }
  }
}

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
  // The expected mean square of a column over the samples is spread / samples times the squared
  // norm of the column.
  const double limit = tolerance * tolerance * static_cast<double>(RowSketch::spread) /
                       static_cast<double>(sketch.samples_);
  PivotedLu lu(std::move(sketch.sums_), columns);
  std::size_t last = 0;  // number of samples to which all elimination steps are applied
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

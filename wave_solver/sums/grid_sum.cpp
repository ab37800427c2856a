#include "wave_solver/sums/grid_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/run/parallel.h"

namespace flatspeckle::wave {

namespace {

using Direction = LineTransform::Direction;

constexpr int least_width = 4, largest_width = 24;
constexpr std::size_t slab_rows = 32, together = 8;
static_assert(slab_rows >= largest_width);

// Returns the values, at multiples of the step, of a window that is 1 up to the distance axis.reach
// and falls smoothly to 0 at half the period of the grid.
std::vector<double> window(const GridShape::Axis& axis, double step, double beta) {
  const Quadrature rule = double_exponential_rule(beta);
  const double middle = (static_cast<double>(axis.size) * step / 2 + axis.reach) / 2;
  const double half = middle - axis.reach;
  const auto integral_from = [&](double t) {
    double sum = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
      sum += rule.weights[i] * bump(beta, (1 + t) / 2 + (1 - t) / 2 * rule.nodes[i]);
    return (1 - t) / 2 * sum;
  };
  const double whole = integral_from(-1);
  std::vector<double> values(axis.size / 2 + 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = (static_cast<double>(i) * step - middle) / half;
    values[i] = t <= -1 ? 1 : t >= 1 ? 0 : integral_from(t) / whole;
  }
  return values;
}

// Returns `values` of an axis, or 1 if the axis has a single line.
template <typename Values>
std::vector<double> unless_single(std::size_t size, const Values& values) {
  return size > 1 ? values() : std::vector<double>{1};
}

// Returns the Fourier transform of the spreading kernel at the frequencies of one axis, up to half
// a period.
std::vector<double> kernel_transform(const GridShape& shape, std::size_t size) {
  const double half_width = shape.width / 2.0;
  const Quadrature rule = double_exponential_rule(shape.beta + std::numbers::pi * half_width);
  std::vector<double> values(size / 2 + 1);
  for (std::size_t m = 0; m < values.size(); ++m) {
    const double phase =
        2 * std::numbers::pi * static_cast<double>(m) / static_cast<double>(size) * half_width;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
      values[m] += half_width * rule.weights[i] * bump(shape.beta, rule.nodes[i]) *
                   std::cos(phase * rule.nodes[i]);
  }
  return values;
}

GridShape::Axis axis(double low, double high, double step, int width, double range, double margin) {
  const double reach = std::max(high - low, 2 * range);
  return {.low = low - width * step / 2,
          .reach = reach,
          .size = transform_size(2 * (reach + margin) / step),
          .used = static_cast<std::size_t>((high - low) / step) + width + 1};
}

}  // namespace

// The spreading kernel has full accuracy for frequencies up to `resolved`, which include those near
// k that carry almost all of the field. From there to the edge of the band its accuracy decreases
// no faster than the transform of the far kernel. A grid that is only slightly finer than the band
// requires is therefore sufficient.
GridShape::GridShape(double k, double range, double tolerance, const PointBounds& box,
                     Radial kind) {
  const double exponent = bump_exponent(tolerance), band = KernelSplit::band(k, range, tolerance);
  constexpr double oversampling = 1.2;
  const double resolved = std::max(0.8 * band, (k + band) / 2);
  step = std::numbers::pi / (oversampling * band);
  const double kept = resolved / (oversampling * band);
  const int needed =
      static_cast<int>(std::ceil(exponent / (std::numbers::pi * std::sqrt(1 - kept))));
  width = std::clamp(needed + needed % 2, least_width, largest_width);
  beta = std::numbers::pi * width * (1 - kept / 2);
  const double margin = 2 * exponent / (band - k);
  x = axis(box.low.x, box.high.x, step, width, range, margin);
  z = axis(box.low.z, box.high.z, step, width, range, margin);
  if (kind == Radial::spherical) y = axis(box.low.y, box.high.y, step, width, range, margin);
}

PointBounds bounds_of_all(std::span<const Vec> points, std::span<const Vec> more) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  PointBounds box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const auto part : {points, more})
    for (const Vec p : part) {
      box.low = {std::min(box.low.x, p.x), std::min(box.low.z, p.z), std::min(box.low.y, p.y)};
      box.high = {std::max(box.high.x, p.x), std::max(box.high.z, p.z), std::max(box.high.y, p.y)};
    }
  return box;
}

GridSum::GridSum(const KernelSplit& split, const GridShape& shape, double tolerance,
                 std::span<const Vec> sources, std::span<const Vec> targets)
    : shape_(shape),
      sources_(footprints(sources)),
      targets_(footprints(targets)),
      along_z_(shape.z.size, Direction::forward),
      along_y_(shape.y.size, Direction::forward),
      along_x_(shape.x.size, Direction::forward),
      back_along_z_(shape.z.size, Direction::backward),
      back_along_y_(shape.y.size, Direction::backward),
      back_along_x_(shape.x.size, Direction::backward) {
  sort_into_slabs();
  make_multiplier(split, tolerance);
}

GridSum::Footprints GridSum::footprints(std::span<const Vec> points) const {
  Footprints made;
  const int width = shape_.width;
  made.row.resize(points.size());
  made.level.resize(points.size());
  made.column.resize(points.size());
  made.row_weights.resize(points.size() * width);
  made.level_weights.assign(points.size() * shape_.levels(), 1);
  made.column_weights.resize(points.size() * width);
  const auto touch = [&](double position, std::uint32_t& line, double* weights) {
    line = static_cast<std::uint32_t>(std::max(position - width / 2.0 + 1, 0.0));
    for (int i = 0; i < width; ++i)
      weights[i] = bump(shape_.beta, (line + i - position) / (width / 2.0));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    touch((points[i].x - shape_.x.low) / shape_.step, made.row[i], &made.row_weights[i * width]);
    touch((points[i].z - shape_.z.low) / shape_.step, made.column[i],
          &made.column_weights[i * width]);
    if (shape_.levels() > 1)
      touch((points[i].y - shape_.y.low) / shape_.step, made.level[i],
            &made.level_weights[i * width]);
  }
  return made;
}

void GridSum::sort_into_slabs() {
  const std::size_t slabs = (shape_.x.used + slab_rows - 1) / slab_rows;
  slab_first_.assign(slabs + 1, 0);
  for (const auto row : sources_.row) ++slab_first_[row / slab_rows + 1];
  for (std::size_t s = 0; s < slabs; ++s) slab_first_[s + 1] += slab_first_[s];
  std::vector<std::uint32_t> next(slab_first_.begin(), slab_first_.end() - 1);
  slab_points_.resize(sources_.row.size());
  for (std::size_t i = 0; i < sources_.row.size(); ++i)
    slab_points_[next[sources_.row[i] / slab_rows]++] = static_cast<std::uint32_t>(i);
}

void GridSum::make_multiplier(const KernelSplit& split, double tolerance) {
  const double beta = bump_exponent(tolerance);
  const auto window_x = window(shape_.x, shape_.step, beta);
  const auto window_z = window(shape_.z, shape_.step, beta);
  const auto window_y =
      unless_single(shape_.y.size, [&] { return window(shape_.y, shape_.step, beta); });
  const std::size_t rows = window_x.size(), columns = window_z.size(), levels = window_y.size();
  multiplier_.resize(rows * columns * levels);
  parallel_for(columns * levels, [&](std::size_t line_number) {
    const std::size_t m = line_number % columns, n = line_number / columns;
    const double across = std::hypot(static_cast<double>(m), static_cast<double>(n));
    std::vector<double> distance(rows);
    for (std::size_t i = 0; i < rows; ++i)
      distance[i] = shape_.step * std::hypot(static_cast<double>(i), across);
    const auto line = std::span(multiplier_).subspan(line_number * rows, rows);
    split.far(distance, line);
    for (std::size_t i = 0; i < rows; ++i) line[i] *= window_x[i] * (window_z[m] * window_y[n]);
  });
  std::vector<std::size_t> sizes{shape_.z.size, shape_.x.size};
  if (levels > 1) sizes.insert(sizes.begin(), shape_.y.size);
  transform_even(multiplier_, sizes);
  const auto kernel_x = kernel_transform(shape_, shape_.x.size);
  const auto kernel_z = kernel_transform(shape_, shape_.z.size);
  const auto kernel_y =
      unless_single(shape_.y.size, [&] { return kernel_transform(shape_, shape_.y.size); });
  const double norm = 1 / shape_.points();
  for (std::size_t n = 0; n < levels; ++n)
    for (std::size_t m = 0; m < columns; ++m)
      for (std::size_t i = 0; i < rows; ++i) {
        const double spread_twice = kernel_x[i] * (kernel_z[m] * kernel_y[n]);
        multiplier_[(n * columns + m) * rows + i] *= norm / (spread_twice * spread_twice);
      }
}

// Spreads the charges onto one slab (a group of grid rows) after another. Every grid line receives
// the contributions in the order of the points, whichever thread computes it.
template <int width>
void GridSum::spread(std::span<const Complex> charges, std::span<Complex> grid) const {
  const auto levels = static_cast<std::size_t>(shape_.levels());
  parallel_for(slab_first_.size() - 1, is_large(), [&](std::size_t slab) {
    const std::size_t begin = slab * slab_rows, end = std::min(begin + slab_rows, shape_.x.used);
    std::fill(&grid[begin * row_size()], &grid[0] + end * row_size(), Complex());
    for (std::uint32_t p = slab_first_[slab == 0 ? 0 : slab - 1]; p < slab_first_[slab + 1]; ++p) {
      const std::size_t i = slab_points_[p], row = sources_.row[i];
      const double* weights = &sources_.column_weights[i * width];
      for (std::size_t r = std::max(row, begin); r < std::min(row + width, end); ++r) {
        const Complex in_row = charges[i] * sources_.row_weights[i * width + (r - row)];
        for (std::size_t level = 0; level < levels; ++level) {
          const Complex charge = in_row * sources_.level_weights[i * levels + level];
          auto* line = reinterpret_cast<double*>(
              &grid[r * row_size() + (sources_.level[i] + level) * shape_.z.size +
                    sources_.column[i]]);
          for (int m = 0; m < width; ++m) {
            line[2 * m] += weights[m] * charge.real();
            line[2 * m + 1] += weights[m] * charge.imag();
          }
        }
      }
    }
  });
}

template <int width>
void GridSum::read(std::span<const Complex> grid, std::span<Complex> sums) const {
  constexpr std::size_t chunk = 1024;
  const auto levels = static_cast<std::size_t>(shape_.levels());
  parallel_for((sums.size() + chunk - 1) / chunk, is_large(), [&](std::size_t c) {
    for (std::size_t i = c * chunk; i < std::min((c + 1) * chunk, sums.size()); ++i) {
      double lines[2 * width] = {};
      for (int r = 0; r < width; ++r)
        for (std::size_t level = 0; level < levels; ++level) {
          const double weight =
              targets_.row_weights[i * width + r] * targets_.level_weights[i * levels + level];
          const auto* line = reinterpret_cast<const double*>(
              &grid[(targets_.row[i] + r) * row_size() +
                    (targets_.level[i] + level) * shape_.z.size + targets_.column[i]]);
          for (int m = 0; m < 2 * width; ++m) lines[m] += weight * line[m];
        }
      Complex sum = 0;
      for (int m = 0; m < width; ++m)
        sum += targets_.column_weights[i * width + m] * Complex(lines[2 * m], lines[2 * m + 1]);
      sums[i] += sum;
    }
  });
}

void GridSum::convolve(std::span<Complex> grid) const {
  const std::size_t row = row_size(), line = shape_.z.size, levels = shape_.y.used;
  parallel_for(shape_.x.used, is_large(), [&](std::size_t i) {
    for (std::size_t n = 0; n < levels; ++n) along_z_(&grid[i * row + n * line]);
    if (shape_.y.size > 1) transform_levels(&grid[i * row], along_y_, levels, shape_.y.size);
  });
  parallel_for((row + together - 1) / together, is_large(), [&](std::size_t block) {
    const std::size_t first = block * together;
    convolve_columns(grid, first, std::min(together, row - first));
  });
  parallel_for(shape_.x.used, is_large(), [&](std::size_t i) {
    if (shape_.y.size > 1) transform_levels(&grid[i * row], back_along_y_, shape_.y.size, levels);
    for (std::size_t n = 0; n < levels; ++n) back_along_z_(&grid[i * row + n * line]);
  });
}

// Transforms one row, [y][z], along y. Levels y >= from are 0, and levels y >= to are not used.
void GridSum::transform_levels(Complex* row, const LineTransform& along_y, std::size_t from,
                               std::size_t to) const {
  const std::size_t size = shape_.y.size, columns = shape_.z.size;
  std::vector<Complex> lines(together * size);
  for (std::size_t first = 0; first < columns; first += together) {
    const std::size_t count = std::min(together, columns - first);
    for (std::size_t n = 0; n < size; ++n)
      for (std::size_t c = 0; c < count; ++c)
        lines[c * size + n] = n < from ? row[n * columns + first + c] : 0;
    for (std::size_t c = 0; c < count; ++c) along_y(&lines[c * size]);
    for (std::size_t n = 0; n < to; ++n)
      for (std::size_t c = 0; c < count; ++c) row[n * columns + first + c] = lines[c * size + n];
  }
}

void GridSum::convolve_columns(std::span<Complex> grid, std::size_t first,
                               std::size_t count) const {
  const std::size_t size = shape_.x.size, half = size / 2, row = row_size(),
                    columns = shape_.z.size;
  std::vector<Complex> lines(count * size);
  for (std::size_t i = 0; i < shape_.x.used; ++i)
    for (std::size_t c = 0; c < count; ++c) lines[c * size + i] = grid[i * row + first + c];
  for (std::size_t c = 0; c < count; ++c) {
    Complex* line = &lines[c * size];
    const std::size_t m = (first + c) % columns, n = (first + c) / columns;
    const std::size_t number =
        std::min(n, shape_.y.size - n) * (columns / 2 + 1) + std::min(m, columns - m);
    const Complex* factor = &multiplier_[number * (half + 1)];
    along_x_(line);
    for (std::size_t i = 0; i <= half; ++i) line[i] = product(line[i], factor[i]);
    for (std::size_t i = half + 1; i < size; ++i) line[i] = product(line[i], factor[size - i]);
    back_along_x_(line);
  }
  for (std::size_t i = 0; i < shape_.x.used; ++i)
    for (std::size_t c = 0; c < count; ++c) grid[i * row + first + c] = lines[c * size + i];
}

template <int width>
void GridSum::add_columns(std::span<const Complex> charges, std::span<Complex> sums) const {
  if constexpr (width < largest_width) {
    if (shape_.width > width) return add_columns<width + 2>(charges, sums);
  }
  const std::size_t from = sources_.row.size(), to = targets_.row.size();
  std::vector<Complex> grid(shape_.x.used * row_size());
  for (std::size_t column = 0; column * from < charges.size(); ++column) {
    spread<width>(charges.subspan(column * from, from), grid);
    convolve(grid);
    read<width>(grid, sums.subspan(column * to, to));
  }
}

void GridSum::add(std::span<const Complex> charges, std::span<Complex> sums) const {
  if (sources_.row.empty() || targets_.row.empty()) return;
  add_columns<least_width>(charges, sums);
}

}  // namespace flatspeckle::wave

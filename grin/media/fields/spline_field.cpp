#include "grin/media/fields/spline_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/frames/frames.h"
#include "core/keys/table_text.h"
#include "core/numbers/wide/every_width.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "grin/media/index/cubic_splines.h"
#include "grin/media/index/field_file.h"
#include "grin/media/index/sample_grid.h"

namespace flatspeckle::grin {

namespace {

constexpr double margin = 1;  // length in cells by which the spline continues beyond the grid

void check_samples(std::span<const double> excess) {
  for (const double e : excess)
    if (!(e > -1 && std::isfinite(e)))
      throw InputError("sample of n - 1", e, "must be finite and above -1");
}

/// Converts samples f[0 .. n-1], given in c[1 .. n], in place to coefficients c[0 .. n+1] of the
/// splines about the nodes -1 .. n. They satisfy (c[i-1] + 4 c[i] + c[i+1]) / 6 = f[i-1]. The third
/// derivative does not jump at the second and the second-to-last node, which determines the
/// coefficients of these nodes directly.
void interpolate(std::vector<double>& c, std::vector<double>& pivot) {
  const std::size_t n = c.size() - 2;
  const auto knot = [&](std::size_t i) { return (8 * c[i] - c[i - 1] - c[i + 1]) / 6; };
  const double f1 = c[1], f2 = c[2], g1 = c[n], g2 = c[n - 1];
  const double first = knot(2), last = knot(n - 1);
  c[2] = first;
  c[n - 1] = last;
  // The equations for the coefficients between these two nodes are tridiagonal, with 4 on the
  // diagonal and 1 beside it. They are solved by elimination downwards and substitution upwards.
  double before = first, p = 0;
  for (std::size_t i = 3; i + 2 <= n; ++i) {
    p = 1 / (4 - p);
    pivot[i] = p;
    before = c[i] = (6 * c[i] - before) * p;
  }
  for (std::size_t i = n - 2; i >= 3; --i) c[i] -= pivot[i] * c[i + 1];
  c[1] = 6 * f2 - 4 * c[2] - c[3];
  c[0] = 6 * f1 - 4 * c[1] - c[2];
  c[n] = 6 * g2 - 4 * c[n - 1] - c[n - 2];
  c[n + 1] = 6 * g1 - 4 * c[n] - c[n - 1];
}

}  // namespace

SplineField::SplineField(const FieldGrid& grid, std::size_t samples, int least_nodes)
    : grid_(grid), per_length_(grid.spacing.cwiseInverse()) {
  check(grid, samples, least_nodes);
  for (int a = 0; a < 3; ++a) extent_[a] = grid.nodes[a] + 2;
  coefficients_.resize(static_cast<std::size_t>(extent_[0]) * extent_[1] * extent_[2]);
}

SplineField SplineField::of_coefficients(const FieldGrid& grid, std::vector<double> coefficients) {
  SplineField field(grid, grid.size(), 2);
  if (coefficients.size() != field.coefficients_.size())
    throw InputError("coefficients of a grid: there are " + std::to_string(coefficients.size()) +
                     "; along each axis their number must be that of the nodes plus 2");
  field.coefficients_ = std::move(coefficients);
  return field;
}

SplineField::SplineField(const FieldGrid& grid, std::span<const double> excess)
    : SplineField(grid, excess.size(), 4) {
  check_samples(excess);
  const auto [nx, ny, nz] = grid.nodes;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      std::copy_n(&excess[(static_cast<std::size_t>(i) * ny + j) * nz], nz,
                  coefficients_.begin() + (row(i + 1, j + 1, 1) - coefficients_.data()));
  std::vector<double> line, pivot;
  const std::array<std::size_t, 3> stride{static_cast<std::size_t>(extent_[1]) * extent_[2],
                                          static_cast<std::size_t>(extent_[2]), 1};
  for (int a = 0; a < 3; ++a) {
    const std::size_t count = extent_[a];
    line.resize(count);
    pivot.resize(count);
    for (std::size_t base = 0; base < coefficients_.size(); ++base) {
      if (base / stride[a] % count != 0) continue;
      for (std::size_t i = 0; i < count; ++i) line[i] = coefficients_[base + i * stride[a]];
      interpolate(line, pivot);
      for (std::size_t i = 0; i < count; ++i) coefficients_[base + i * stride[a]] = line[i];
    }
  }
}

template <int Derivatives>
SplineField::Axis SplineField::axis(const Vec3& x, int which) const {
  const double scale = per_length_[which], cells = grid_.nodes[which] - 1;
  const double position = (x[which] - grid_.origin[which]) * scale;
  const double held = std::clamp(position, -margin, cells + margin);
  const double cell = cell_of(held, cells), scale_inside = position == held ? scale : 0;
  const CubicSplines splines{held - cell};
  const auto four = [](const CubicSplines::Four& values) {
    return Eigen::Map<const Axis::Four>(values.data());
  };
  Axis result;
  result.cell = static_cast<int>(cell);
  result.w = four(splines.values());
  if constexpr (Derivatives >= 1) result.d = four(splines.derivatives(scale_inside));
  if constexpr (Derivatives >= 2)
    result.dd = four(splines.second_derivatives(scale_inside * scale_inside));
  return result;
}

// Sums over x and y process four splines along z at a time.

double SplineField::excess(const Vec3& x) const {
  const Axis a = axis<0>(x, 0), b = axis<0>(x, 1), c = axis<0>(x, 2);
  Axis::Four sum = Axis::Four::Zero();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) sum += a.w[i] * b.w[j] * four(a.cell + i, b.cell + j, c.cell);
  return (sum * c.w).sum();
}

IndexGradient SplineField::gradient(const Vec3& x) const {
  const Axis a = axis<1>(x, 0), b = axis<1>(x, 1), c = axis<1>(x, 2);
  Axis::Four f = Axis::Four::Zero(), fx = f, fy = f;
  for (int i = 0; i < 4; ++i) {
    Axis::Four g = Axis::Four::Zero(), gy = g;
    for (int j = 0; j < 4; ++j) {
      const auto values = four(a.cell + i, b.cell + j, c.cell);
      g += b.w[j] * values;
      gy += b.d[j] * values;
    }
    f += a.w[i] * g;
    fx += a.d[i] * g;
    fy += a.w[i] * gy;
  }
  return {(f * c.w).sum(), {(fx * c.w).sum(), (fy * c.w).sum(), (f * c.d).sum()}};
}

/// Sums the splines of one lane (f) and their derivatives with respect to x and y (fx, fy) over x
/// and y. Each sum consists of four numbers, for the four splines along z.
inline void SplineField::add_rows(const std::array<LaneAxis, 3>& axes, int lane, WideFour& f,
                                  WideFour& fx, WideFour& fy) const {
  const auto& [a, b, c] = axes;
  const double* first = row(static_cast<int>(a.cell[lane]), static_cast<int>(b.cell[lane]),
                            static_cast<int>(c.cell[lane]));
  f = fx = fy = WideFour{};
  for (int i = 0; i < 4; ++i) {
    WideFour g{}, gy{};
    for (int j = 0; j < 4; ++j) {
      WideFour values;
      load(first + (i * extent_[1] + j) * extent_[2], values);
      g += b.w[j][lane] * values;
      gy += b.d[j][lane] * values;
    }
    f += a.w[i][lane] * g;
    fx += a.d[i][lane] * g;
    fy += a.w[i][lane] * gy;
  }
}

inline void SplineField::locate_along(int which, const double* x, LaneAxis& found) const {
  const double scale = per_length_[which], cells = grid_.nodes[which] - 1;
  const double origin = grid_.origin[which];
#pragma omp simd
  for (int k = 0; k < lanes; ++k) {
    const double place = (x[k] - origin) * scale;
    const double held = std::clamp(place, -margin, cells + margin), cell = cell_of(held, cells);
    const CubicSplines splines{held - cell};
    const CubicSplines::Four w = splines.values(),
                             d = splines.derivatives(place == held ? scale : 0);
    found.cell[k] = cell;
    found.w[0][k] = w[0];
    found.w[1][k] = w[1];
    found.w[2][k] = w[2];
    found.w[3][k] = w[3];
    found.d[0][k] = d[0];
    found.d[1][k] = d[1];
    found.d[2][k] = d[2];
    found.d[3][k] = d[3];
  }
}

FLATSPECKLE_EVERY_WIDTH void SplineField::gradients(const LaneVectors& x,
                                                    LaneGradients& found) const {
  std::array<LaneAxis, 3> axes;
  locate_along(0, x.x, axes[0]);
  locate_along(1, x.y, axes[1]);
  locate_along(2, x.z, axes[2]);
  const LaneAxis& z = axes[2];
  for (int k = 0; k < lanes; k += 4) {
    WideFour f[4], fx[4], fy[4];
    for (int i = 0; i < 4; ++i) add_rows(axes, k + i, f[i], fx[i], fy[i]);
    transpose(f);
    transpose(fx);
    transpose(fy);
    const auto sum = [k](const WideFour* values, const double(*weights)[lanes], double* to) {
      WideFour all{};
      for (int i = 0; i < 4; ++i) all += values[i] * wide_four_at(weights[i] + k);
      wide_four_at(to + k) = all;
    };
    sum(f, z.w, found.excess);
    sum(fx, z.w, found.gradient.x);
    sum(fy, z.w, found.gradient.y);
    sum(f, z.d, found.gradient.z);
  }
}

IndexHessian SplineField::hessian(const std::array<Axis, 3>& axes) const {
  const auto& [a, b, c] = axes;
  Axis::Four f = Axis::Four::Zero(), fx = f, fy = f, fxx = f, fxy = f, fyy = f;
  for (int i = 0; i < 4; ++i) {
    Axis::Four g = Axis::Four::Zero(), gy = g, gyy = g;
    for (int j = 0; j < 4; ++j) {
      const auto values = four(a.cell + i, b.cell + j, c.cell);
      g += b.w[j] * values;
      gy += b.d[j] * values;
      gyy += b.dd[j] * values;
    }
    f += a.w[i] * g;
    fx += a.d[i] * g;
    fy += a.w[i] * gy;
    fxx += a.dd[i] * g;
    fxy += a.d[i] * gy;
    fyy += a.w[i] * gyy;
  }
  const double xy = (fxy * c.w).sum(), xz = (fx * c.d).sum(), yz = (fy * c.d).sum();
  return {
      (f * c.w).sum(),
      {(fx * c.w).sum(), (fy * c.w).sum(), (f * c.d).sum()},
      Mat3{{(fxx * c.w).sum(), xy, xz}, {xy, (fyy * c.w).sum(), yz}, {xz, yz, (f * c.dd).sum()}}};
}

IndexHessian SplineField::hessian(const Vec3& x) const {
  return hessian({axis<2>(x, 0), axis<2>(x, 1), axis<2>(x, 2)});
}

SplineField::Evaluation SplineField::evaluate(const Vec3& x) const {
  const std::array<Axis, 3> axes{axis<2>(x, 0), axis<2>(x, 1), axis<2>(x, 2)};
  return {axes, hessian(axes)};
}

/// Returns the difference of the largest and the smallest coefficient. This is a bound, because a
/// spline is a weighted mean of its coefficients.
double SplineField::range() const {
  const auto [least, most] = std::minmax_element(coefficients_.begin(), coefficients_.end());
  return *most - *least;
}

SplineField read_spline_field(const std::filesystem::path& path) {
  return read_grid<SplineField>(path, "excess");
}

FieldFacts facts(const SplineField& field) {
  const FieldGrid& grid = field.grid();
  return {.scale = 2 * grid.spacing.minCoeff(),
          .strength = 4 * field.range(),
          .grid = Box{grid.origin, grid.end()}};
}

void add_keys(Keys& keys, GridValues& values) {
  keys.add("grid", values.grid,
           "Grid of the index: HDF5 with excess[x, y, z] = n - 1, or index[x, y, z] = n, and its "
           "attributes origin, spacing; or an array [x, y, z] as NPY")
      .file();
  keys.add("grid_values", values.grid_values,
           "Whether the grid contains n or n - 1 (excess); if unstated, n - 1, and a grid that "
           "seems "
           "to contain n is rejected")
      .one_of({"unstated", "excess", "index"})
      .only_of("grid");
  keys.add("grid_origin", values.grid_origin, "x y z of the first node of a grid in an NPY file")
      .exactly(3, "x y z")
      .unit("length")
      .only_of("a grid in an NPY file");
  keys.add("grid_spacing", values.grid_spacing,
           "Spacing of the nodes of a grid in an NPY file along x, y and z")
      .exactly(3, "x y z")
      .unit("length")
      .only_of("a grid in an NPY file");
}

namespace {

/// Reads the samples of a grid from HDF5 or NPY and converts them to n - 1.
GridSamples read_excess(const Keys& keys, const GridValues& values, const std::string& path) {
  const std::string& stated = keys.read(values.grid_values);
  const bool is_index = stated == "index";
  GridSamples samples;
  if (file_bytes(path).starts_with("\x93NUMPY")) {
    const Frames planes = read_frames(keys.name(values.grid), path, {});
    samples.where = {vector_of(keys.required(values.grid_origin)),
                     vector_of(keys.required(values.grid_spacing)),
                     {static_cast<int>(planes.count()), static_cast<int>(planes.rows),
                      static_cast<int>(planes.columns)}};
    samples.values = planes.values;
    check(samples.where, samples.values.size(), 2);
    check_range(samples);
  } else {
    const std::string dataset = is_index ? "index" : "excess";
    if (!guarded_read(path, [&] { return ResultReader(path).has(dataset); }))
      throw InputError(path + ": has no dataset " + dataset +
                       ": requires excess[x, y, z] = n - 1, or index[x, y, z] = n with "
                       "grid_values = index");
    samples = read_samples(path, dataset);
  }
  constexpr double least_index = 0.9;
  if (const double least = std::ranges::min(samples.values);
      stated == "unstated" && least >= least_index)
    throw InputError(path + ": all values are " + std::to_string(least) +
                     " or more: if they are n, give grid_values = index, if n - 1, grid_values = "
                     "excess");
  if (is_index)
    for (double& value : samples.values) value -= 1;
  return samples;
}

}  // namespace

SplineField make_field(const Keys& keys, const GridValues& values, const FieldUse&) {
  return read_field(keys, keys.required(values.grid), [&](const std::string& path) {
    const auto [where, excess] = read_excess(keys, values, path);
    return SplineField(where, excess);
  });
}

}  // namespace flatspeckle::grin

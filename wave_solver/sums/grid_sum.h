#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/fourier.h"
#include "flatland/media/domain.h"
#include "wave_solver/sums/kernel_split.h"

namespace flatspeckle::wave {

/// Smallest box that contains points in the plane or in space; infinite and empty without points.
struct PointBounds {
  Vec low, high;

  double extent() const { return std::max({high.x - low.x, high.z - low.z, high.y - low.y}); }
};
PointBounds bounds_of_all(std::span<const Vec> points, std::span<const Vec> more = {});

/// Periodic grid on which the far part of a KernelSplit is summed between points of a box, and the
/// kernel that spreads charges onto the grid. In the plane the axis y has a single line.
struct GridShape {
  struct Axis {
    double low;        // coordinate of the first used grid line
    double reach;      // largest distance between points, at least 2 range
    std::size_t size;  // grid lines per period; lines from `used` on are empty
    std::size_t used;
  };
  GridShape(double k, double range, double tolerance, const PointBounds& box,
            Radial kind = Radial::cylindrical);

  double points() const {
    return static_cast<double>(x.size) * static_cast<double>(y.size) * static_cast<double>(z.size);
  }
  /// Width of the spreading kernel along y.
  int levels() const { return y.size > 1 ? width : 1; }

  double step;
  int width;    // width of the spreading kernel, in steps; even
  double beta;  // parameter of bump(), which is the spreading kernel
  Axis x, z, y{.low = 0, .reach = 0, .size = 1, .used = 1};
};

/// Computes u_i = sum_j far(|x_i - y_j|) q_j over all pairs: charges q_j are spread onto the grid,
/// convolved on it by FFT, and interpolated at the points x_i. far: far part of the KernelSplit.
/// The grid has the order [x][y][z]: the points of equal x are a row, which is a line in the plane.
/// The relative error is the tolerance, but not less than about 1e-13.
class GridSum {
 public:
  GridSum(const KernelSplit& split, const GridShape& shape, double tolerance,
          std::span<const Vec> sources, std::span<const Vec> targets);

  /// Computes the sums for several columns of charges, [column][source], and adds them to `sums`,
  /// [column][target]. Threaded unless called from a parallel region; the result does not depend on
  /// the number of threads.
  void add(std::span<const Complex> charges, std::span<Complex> sums) const;

 private:
  // Grid lines within the spreading kernel of each point: the first row (x), level (y) and column
  // (z), and the values of the kernel on them.
  struct Footprints {
    std::vector<std::uint32_t> row, level, column;
    std::vector<double> row_weights, level_weights, column_weights;
  };
  // Whether the sum takes long enough for threads to be worthwhile, about a millisecond.
  bool is_large() const { return shape_.x.used * row_size() > 50000; }
  std::size_t row_size() const { return shape_.y.size * shape_.z.size; }
  Footprints footprints(std::span<const Vec> points) const;
  void sort_into_slabs();
  void make_multiplier(const KernelSplit& split, double tolerance);
  template <int width>
  void spread(std::span<const Complex> charges, std::span<Complex> grid) const;
  template <int width>
  void read(std::span<const Complex> grid, std::span<Complex> sums) const;
  template <int width>
  void add_columns(std::span<const Complex> charges, std::span<Complex> sums) const;
  void convolve(std::span<Complex> grid) const;
  void transform_levels(Complex* row, const LineTransform& along_y, std::size_t from,
                        std::size_t to) const;
  void convolve_columns(std::span<Complex> grid, std::size_t first, std::size_t count) const;

  GridShape shape_;
  Footprints sources_, targets_;
  std::vector<std::uint32_t> slab_first_, slab_points_;  // sources sorted into slabs of grid rows
  std::vector<Complex> multiplier_;  // [y frequency][z][x], all up to half a period
  LineTransform along_z_, along_y_, along_x_, back_along_z_, back_along_y_, back_along_x_;
};

}  // namespace flatspeckle::wave

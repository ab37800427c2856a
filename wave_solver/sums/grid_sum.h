#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/fourier.h"
#include "flatland/media/domain.h"
#include "wave_solver/sums/kernel_split.h"

namespace flatspeckle::wave {

/// Periodic grid on which the far part of a KernelSplit is summed between points of a rectangle,
/// and the kernel that spreads charges onto the grid.
struct GridShape {
  struct Axis {
    double low;        // coordinate of the first used grid line
    double reach;      // largest distance between points, at least 2 range
    std::size_t size;  // grid lines per period; lines from `used` on are empty
    std::size_t used;
  };
  GridShape(double k, double range, double tolerance, const Rectangle& box);

  double step;
  int width;    // width of the spreading kernel, in steps; even
  double beta;  // parameter of bump(), which is the spreading kernel
  Axis x, z;
};

/// Computes u_i = sum_j far(|x_i - y_j|) q_j over all pairs: charges q_j are spread onto the grid,
/// convolved on it by FFT, and interpolated at the points x_i. far: far part of the KernelSplit.
/// Lines of equal x are rows of the grid. The relative error is the tolerance, but not less than
/// about 1e-13.
class GridSum {
 public:
  GridSum(const KernelSplit& split, const GridShape& shape, double tolerance,
          std::span<const Vec> sources, std::span<const Vec> targets);

  /// Computes the sums for several columns of charges, [column][source], and adds them to `sums`,
  /// [column][target]. Threaded unless called from a parallel region; the result does not depend on
  /// the number of threads.
  void add(std::span<const Complex> charges, std::span<Complex> sums) const;

 private:
  // Grid lines within the spreading kernel of each point: the first row and column, and the values
  // of the kernel on `width` rows and columns.
  struct Footprints {
    std::vector<std::uint32_t> row, column;
    std::vector<double> row_weights, column_weights;
  };
  // Whether the sum takes long enough for threads to be worthwhile, about a millisecond.
  bool is_large() const { return shape_.x.used * shape_.z.size > 50000; }
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
  void convolve_columns(std::span<Complex> grid, std::size_t first, std::size_t count) const;

  GridShape shape_;
  Footprints sources_, targets_;
  std::vector<std::uint32_t> slab_first_, slab_points_;  // sources sorted into slabs of grid rows
  std::vector<Complex> multiplier_;  // [z frequency][x frequency], both up to half a period
  LineTransform along_z_, along_x_, back_along_z_, back_along_x_;
};

}  // namespace flatspeckle::wave

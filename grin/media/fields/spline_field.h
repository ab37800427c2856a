#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/numbers/wide/four.h"
#include "grin/media/index/field_kind.h"
#include "grin/media/index/lanes.h"
#include "grin/media/index/sample_grid.h"

namespace flatspeckle::grin {

/// Tensor-product cubic spline through samples of n - 1, with not-a-knot end conditions. It
/// reproduces cubics and has two continuous derivatives. It continues for one cell beyond the grid,
/// so that the steps of a ray that is stopped on the grid's box stay smooth. Farther out, the index
/// equals its value at the nearest point of the continued region.
class SplineField {
 public:
  /// Throws InputError for fewer than 4 nodes along an axis, a spacing <= 0, a number of samples
  /// other than the number of nodes, or a sample that is not a finite number > -1.
  SplineField(const FieldGrid& grid, std::span<const double> excess);

  /// Returns the field with given coefficients of the B-splines about the nodes -1, 0, ..., N along
  /// each axis, where N is the number of nodes. Throws InputError for fewer than 2 nodes along an
  /// axis, or a wrong number of coefficients.
  static SplineField of_coefficients(const FieldGrid& grid, std::vector<double> coefficients);

  const FieldGrid& grid() const { return grid_; }
  const std::vector<double>& coefficients() const { return coefficients_; }
  /// Returns the number of coefficients along each axis.
  const std::array<int, 3>& extent() const { return extent_; }

  double excess(const Vec3& x) const;
  IndexGradient gradient(const Vec3& x) const;
  void gradients(const LaneVectors& x, LaneGradients& found) const;
  IndexHessian hessian(const Vec3& x) const;

  /// Returns an upper bound of the difference of the index between any two points.
  double range() const;

  /// The four splines along an axis that are nonzero at a position x: index of the first (cell),
  /// values w, and first and second derivatives d and dd with respect to x.
  struct Axis {
    using Four = Eigen::Array4d;
    int cell;
    Four w, d, dd;
  };
  /// Result of evaluate(): the nonzero splines along each axis at a point, and the field with its
  /// derivatives there.
  struct Evaluation {
    std::array<Axis, 3> axes;
    IndexHessian jet;
  };
  Evaluation evaluate(const Vec3& x) const;
  /// Adds the derivatives of a (n - 1) + b . grad n with respect to the coefficients to sums, one
  /// for each coefficient. The sums of the coefficients with number i along x and j along y form a
  /// row along z, which begins at row_of(i * extent[1] + j).
  template <class Rows>
  static void add_derivative(const Evaluation& at, const std::array<int, 3>& extent, double a,
                             const Vec3& b, const Rows& row_of) {
    const auto& [x, y, z] = at.axes;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const double along = b[2] * x.w[i] * y.w[j];
        const double value = (a * x.w[i] + b[0] * x.d[i]) * y.w[j] + b[1] * x.w[i] * y.d[j];
        Eigen::Map<Axis::Four> row(row_of((x.cell + i) * extent[1] + y.cell + j) + z.cell);
        row += value * z.w + along * z.d;
      }
  }

 private:
  SplineField(const FieldGrid& grid, std::size_t samples, int least_nodes);
  template <int Derivatives>
  Axis axis(const Vec3& x, int which) const;
  /// Cell, values w and derivatives d of the splines along one axis, in each lane.
  struct LaneAxis {
    alignas(64) double cell[lanes], w[4][lanes], d[4][lanes];
  };
  void locate_along(int which, const double* x, LaneAxis& found) const;
  void add_rows(const std::array<LaneAxis, 3>& axes, int lane, WideFour& f, WideFour& fx,
                WideFour& fy) const;
  IndexHessian hessian(const std::array<Axis, 3>& axes) const;
  Eigen::Map<const Axis::Four> four(int i, int j, int k) const {
    return Eigen::Map<const Axis::Four>(row(i, j, k));
  }
  const double* row(int i, int j, int k) const {
    return &coefficients_[(static_cast<std::size_t>(i) * extent_[1] + j) * extent_[2] + k];
  }

  FieldGrid grid_;
  Vec3 per_length_;            ///< number of cells per unit of length along each axis
  std::array<int, 3> extent_;  ///< number of coefficients along each axis: nodes + 2
  std::vector<double> coefficients_;
};

/// Reads the field from the dataset "excess" of a file, with read_samples().
SplineField read_spline_field(const std::filesystem::path& path);

/// Returns the properties of the field. The length over which the index varies (scale) is two node
/// spacings, and the field fills the box of the samples (grid).
FieldFacts facts(const SplineField& field);

struct GridValues {
  using Field = SplineField;
  static constexpr const char* word = "grid";
  static constexpr bool is_medium = false;
  std::string grid{}, grid_values = "unstated";
  std::vector<double> grid_origin{}, grid_spacing{};
};

void add_keys(Keys& keys, GridValues& values);
/// Reads the field from the file given by its key. Throws an InputError that names the file.
SplineField make_field(const Keys& keys, const GridValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin

#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/numbers/wide/four.h"
#include "grin/media/index/field_kind.h"
#include "grin/media/index/lanes.h"
#include "grin/media/index/sample_grid.h"

namespace flatspeckle::grin {

/// The tensor-product cubic spline through samples of n - 1, not-a-knot at the ends: it reproduces
/// cubics, and has two continuous derivatives. It goes on as it is for one cell beyond the grid, so
/// that the steps of a ray that is stopped on the grid's box stay smooth; farther out the index is
/// that of the nearest point there.
class SplineField {
 public:
  /// Throws InputError for fewer than 4 nodes along an axis, a spacing <= 0, another number of
  /// samples than nodes, or a sample that is not a finite number > -1.
  SplineField(const FieldGrid& grid, std::span<const double> excess);

  /// Of the coefficients of its B-splines themselves, those about nodes -1 .. nodes along each
  /// axis. Throws InputError for fewer than 2 nodes along an axis, or another number of
  /// coefficients.
  static SplineField of_coefficients(const FieldGrid& grid, std::vector<double> coefficients);

  const FieldGrid& grid() const { return grid_; }
  const std::vector<double>& coefficients() const { return coefficients_; }
  const std::array<int, 3>& extent() const { return extent_; }  ///< of the coefficients

  double excess(const Vec3& x) const;
  IndexGradient gradient(const Vec3& x) const;
  void gradients(const LaneVectors& x, LaneGradients& found) const;
  IndexHessian hessian(const Vec3& x) const;

  /// No two places have indices farther apart.
  double range() const;

  /// The four splines that are there along an axis: the first, their values and derivatives by x.
  struct Axis {
    using Four = Eigen::Array4d;
    int cell;
    Four w, d, dd;
  };
  /// A place, and the field there.
  struct Look {
    std::array<Axis, 3> axes;
    IndexHessian jet;
  };
  Look look(const Vec3& x) const;
  /// Adds the derivatives of a excess + b . gradient there by the coefficients, to rows of them
  /// along z: that of the i-th along x and the j-th along y begins at row_of(i extent[1] + j).
  template <class Rows>
  static void add_derivative(const Look& at, const std::array<int, 3>& extent, double a,
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
  /// Of one axis, in lanes.
  struct LaneAxis {
    alignas(64) double cell[lanes], w[4][lanes], d[4][lanes];
  };
  void look_along(int which, const double* x, LaneAxis& found) const;
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
  Vec3 per_length_;            ///< cells
  std::array<int, 3> extent_;  ///< nodes + 2
  std::vector<double> coefficients_;
};

/// Dataset "excess" (read_samples).
SplineField read_spline_field(const std::filesystem::path& path);

/// Two spacings are the scale, and the samples' box the end.
FieldFacts facts(const SplineField& field);

struct GridValues {
  using Field = SplineField;
  static constexpr const char* word = "grid";
  static constexpr bool is_medium = false;
  std::string grid{};
};

void add_keys(Keys& keys, GridValues& values);
/// Throws InputError naming the file.
SplineField make_field(const Keys& keys, const GridValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin

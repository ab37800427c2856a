#pragma once

#include <array>
#include <span>
#include <vector>

#include "grin/index/field_kind.h"
#include "grin/index/sample_grid.h"

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

  const FieldGrid& grid() const { return grid_; }

  double excess(const Vec3& x) const;
  IndexGradient gradient(const Vec3& x) const;
  IndexHessian hessian(const Vec3& x) const;

  /// No two places have indices farther apart.
  double range() const;

 private:
  /// Cell and weights of the four splines there, and of their derivatives by x.
  struct Axis {
    int cell;
    std::array<double, 4> w, d, dd;
  };
  template <int Derivatives>
  Axis axis(const Vec3& x, int which) const;
  const double* row(int i, int j, int k) const {
    return &coefficients_[(static_cast<std::size_t>(i) * extent_[1] + j) * extent_[2] + k];
  }

  FieldGrid grid_;
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

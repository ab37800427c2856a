#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "grin/media/fields/spline_field.h"
#include "grin/rays/surfaces/spline_cell.h"

namespace flatspeckle::grin {

/// A sum of cubic B-splines on a grid of cubes, and in which of its cells it may be 0.
class LevelGrid {
 public:
  using Cell = std::array<int, 3>;

  /// As LevelSurface.
  LevelGrid(const Vec3& origin, double spacing, const std::array<int, 3>& nodes,
            std::vector<double> coefficients);

  const SplineField& f() const { return f_; }
  double spacing() const { return spacing_; }
  double steepest() const { return steepest_; }  ///< |gradient of f| is nowhere more
  double rounding() const { return rounding_; }  ///< of f
  double volume() const { return volume_; }      ///< where f is negative
  /// Around the cells where f may be 0.
  const Box& bounds() const { return bounds_; }

  /// In units of cells, from the low corner of the first one.
  Vec3 place(const Vec3& x) const { return (x - f_.grid().origin) / spacing_; }
  bool has(const Cell& c) const {
    for (int a = 0; a < 3; ++a)
      if (c[a] < 0 || c[a] >= cells_[a]) return false;
    return true;
  }
  /// How many cells away, along any axis, is one where f may be 0.
  int clearance(const Cell& c) const { return clear_[number(c)]; }
  /// No more than the distance of a place in the grid from where f is 0.
  double clear_way(const Vec3& x) const {
    const Vec3 at = place(x).array().floor();
    const Cell c{static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])};
    return has(c) ? spacing_ * std::max(clearance(c) - 1, 0) : 0;
  }
  SplineCell cell(const Cell& c) const;

 private:
  std::size_t number(const Cell& c) const {
    return (static_cast<std::size_t>(c[0]) * cells_[1] + c[1]) * cells_[2] + c[2];
  }
  template <class Use>
  void for_each_cell(const Use& use) const;
  void find_zeros();
  void add_up();
  void spread_along(int axis);

  SplineField f_;
  double spacing_;
  std::array<int, 3> cells_;
  std::vector<std::uint8_t> clear_;
  double steepest_ = 1, rounding_ = 0;
  double volume_ = 0;
  Box bounds_;
};

}  // namespace flatspeckle::grin

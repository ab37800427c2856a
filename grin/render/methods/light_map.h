#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// Equal cells of a box; cell number = (x columns_y + y) columns_z + z.
class BoxCells {
 public:
  BoxCells(const Box& box, const std::array<int, 3>& counts);

  const std::array<int, 3>& counts() const { return counts_; }
  const Box& bounds() const { return box_; }
  double volume(int) const { return sides_.prod(); }
  /// The shortest side of a cell.
  double spacing() const { return sides_.minCoeff(); }
  /// -1 outside.
  int cell_at(const Vec3& x) const;
  /// Centres along an axis.
  std::vector<double> centres(int axis) const;

 private:
  Box box_;
  std::array<int, 3> counts_;
  Vec3 sides_;
};

/// Rings of a cylinder, of equal widths and heights; cell number = ring slices + slice.
class RingCells {
 public:
  /// The axis is from the first point to the second.
  RingCells(const Vec3& from, const Vec3& to, double radius, const std::array<int, 2>& counts);

  const std::array<int, 2>& counts() const { return counts_; }
  /// All of the cylinder, and perhaps a little more.
  Box bounds() const;
  double volume(int cell) const;
  double spacing() const { return std::min(width_, height_); }
  /// -1 outside.
  int cell_at(const Vec3& x) const;
  /// Middles between the radii of the rings, and along the axis.
  std::vector<double> radii() const;
  std::vector<double> depths() const;

 private:
  Vec3 from_, axis_;
  std::array<int, 2> counts_;
  double width_, height_;
};

/// Where in the stage light is counted: its fluence rate and the power that is absorbed.
using LightMap = std::variant<BoxCells, RingCells>;
int cells(const LightMap& map);

}  // namespace flatspeckle::grin

#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// Equal cells of a box. Cell (x, y, z) has the number (x * counts[1] + y) * counts[2] + z.
class BoxCells {
 public:
  BoxCells(const Box& box, const std::array<int, 3>& counts);

  const std::array<int, 3>& counts() const { return counts_; }
  const Box& bounds() const { return box_; }
  double volume(int) const { return sides_.prod(); }
  /// The shortest side of a cell.
  double spacing() const { return sides_.minCoeff(); }
  /// Returns the cell that contains x, -1 outside.
  int cell_at(const Vec3& x) const;
  /// Centres along an axis.
  std::vector<double> centres(int axis) const;

 private:
  Box box_;
  std::array<int, 3> counts_;
  Vec3 sides_;
};

/// Cells of a cylinder: rings of equal width and height. Rings are counted along the radius and
/// slices along the axis; cell (ring, slice) has the number ring * slices + slice.
class RingCells {
 public:
  /// The axis extends from `from` to `to`.
  RingCells(const Vec3& from, const Vec3& to, double radius, const std::array<int, 2>& counts);

  const std::array<int, 2>& counts() const { return counts_; }
  /// A box that contains the cylinder.
  Box bounds() const;
  double volume(int cell) const;
  double spacing() const { return std::min(width_, height_); }
  /// Returns the cell that contains x, -1 outside.
  int cell_at(const Vec3& x) const;
  /// radii() returns the middles of the rings along the radius, depths() those of the slices along
  /// the axis.
  std::vector<double> radii() const;
  std::vector<double> depths() const;

 private:
  Vec3 from_, axis_;
  std::array<int, 2> counts_;
  double width_, height_;
  double rings_per_length_, slices_per_length_;
};

/// Cells in the stage for the fluence rate and the absorbed power.
using LightMap = std::variant<BoxCells, RingCells>;
int cells(const LightMap& map);

}  // namespace flatspeckle::grin

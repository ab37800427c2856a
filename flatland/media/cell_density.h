#pragma once

#include "flatland/media/density_map.h"

namespace flatspeckle {

/// Relative density of equal rectangular cells that fill a box, constant in each.
class CellDensity : public DensityMap {
 public:
  /// [row][column], rows from z = 0 on, columns from x = -width/2 on; none negative.
  CellDensity(Domain box, Material material, std::size_t rows, std::vector<double> density);

  double relative_density(Vec2 x) const override;
  std::string describe() const override;

 private:
  double met(Vec2 x, Vec2 w, double length) const override;
  double most_relative() const override;
  double mean_relative() const override;

  std::size_t rows_, columns_;
  double across_, deep_;  ///< extents of a cell
  std::vector<double> density_;
};

}  // namespace flatspeckle

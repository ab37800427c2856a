#pragma once

#include <span>
#include <vector>

#include "grin/media/index/sample_grid.h"

namespace flatspeckle::grin {

/// A relative density on a grid, trilinear between the nodes, 0 outside the grid.
class DensityGrid {
 public:
  /// Throws InputError for fewer than 2 nodes along an axis, a spacing <= 0, another number of
  /// values than nodes, or a value that is negative or not finite.
  DensityGrid(const FieldGrid& grid, std::span<const double> density);

  double operator()(const Vec3& x) const;
  double largest() const { return largest_; }
  const FieldGrid& grid() const { return grid_; }

 private:
  FieldGrid grid_;
  Vec3 per_spacing_;
  std::vector<double> density_;
  double largest_ = 0;
};

/// Dataset "density" (read_samples).
DensityGrid read_density_grid(const std::filesystem::path& path);

}  // namespace flatspeckle::grin

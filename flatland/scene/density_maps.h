#pragma once

#include <functional>
#include <memory>

#include "core/result/dataset_row.h"
#include "flatland/media/medium_profile.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

/// One material whose density varies over a box. Derived classes define the relative density and
/// its integral along a path. reach() solves for the path length at which mu_t times this integral
/// is a given optical depth.
class DensityMap : public MediumProfile {
 public:
  DensityMap(Domain box, Material material);

  std::size_t material_at(Vec) const override { return 0; }
  double most_density() const override { return most_relative() * bulk().density; }
  double optical_depth(Vec x, Vec w, double length) const override {
    return bulk().mu_t * met(x, w, length);
  }
  double reach(Vec x, Vec w, double optical_depth, double longest) const override;
  BulkMedium mean() const override;
  void write(ResultFile& file) const override;

 protected:
  const Domain& box() const { return box_; }
  const BulkMedium& bulk() const { return materials().front().medium; }

 private:
  /// Returns the integral of relative_density() over a path of the given length from x along w.
  virtual double met(Vec x, Vec w, double length) const = 0;
  virtual double most_relative() const = 0;
  /// Returns the mean relative density of the box.
  virtual double mean_relative() const = 0;

  Domain box_;
};

extern const DatasetTable density_table;

/// Relative density that is constant within each of the equal cells that fill a box: rectangles or,
/// in space, cuboids (voxels).
class CellDensity : public DensityMap {
 public:
  /// Numbers of cells along x, z and y.
  struct Counts {
    std::size_t x = 1, z = 1, y = 1;
  };

  /// density: relative density of each cell, [z][y][x]. The first cell begins at z = 0, y =
  /// -height/2 and x = -width/2. No value may be negative.
  CellDensity(Domain box, Material material, Counts counts, std::vector<double> density);

  double relative_density(Vec x) const override;
  std::shared_ptr<const MediumProfile> with(std::vector<Material> materials) const override;
  std::string describe() const override;

 private:
  double met(Vec x, Vec w, double length) const override;
  double most_relative() const override;
  double mean_relative() const override;
  /// Returns the coordinates of a point in units of cells, from the corner of the first cell.
  Vec in_cells(Vec x) const;
  /// Returns the density of the cell with these numbers.
  double density_of(std::ptrdiff_t x, std::ptrdiff_t z, std::ptrdiff_t y) const;

  Counts counts_;
  Vec size_;  ///< extents of a cell; y is 1 in the plane
  std::vector<double> density_;
};

/// Function that creates a density map for a given box and material.
using MakeDensityMap =
    std::function<std::shared_ptr<const MediumProfile>(const Domain&, const Material&)>;

/// Returns the function that creates the density map given by density_blobs or density_map. The
/// returned function is empty if neither key is given. Reads these keys and the file. Throws
/// InputError.
MakeDensityMap density_map(const Keys& keys, const SceneSpec& spec);

}  // namespace flatspeckle

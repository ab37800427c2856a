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

/// Relative density that is constant within each of the equal rectangular cells that fill a box.
class CellDensity : public DensityMap {
 public:
  /// density: relative density of each cell, [row][column]. Row 0 begins at z = 0, column 0 at x =
  /// -width/2. No value may be negative.
  CellDensity(Domain box, Material material, std::size_t rows, std::vector<double> density);

  double relative_density(Vec x) const override;
  std::string describe() const override;

 private:
  double met(Vec x, Vec w, double length) const override;
  double most_relative() const override;
  double mean_relative() const override;

  std::size_t rows_, columns_;
  double across_, deep_;  ///< extents of a cell along x and along z
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

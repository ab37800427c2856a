#pragma once

#include <functional>
#include <memory>

#include "core/result/dataset_row.h"
#include "flatland/media/medium_profile.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

/// One material whose density varies over a box. Kinds of maps give it, and how much of it a way
/// meets; how far an optical depth reaches follows.
class DensityMap : public MediumProfile {
 public:
  DensityMap(Domain box, Material material);

  std::size_t material_at(Vec2) const override { return 0; }
  double most_density() const override { return most_relative() * bulk().density; }
  double optical_depth(Vec2 x, Vec2 w, double length) const override {
    return bulk().mu_t * met(x, w, length);
  }
  double reach(Vec2 x, Vec2 w, double optical_depth, double longest) const override;
  BulkMedium mean() const override;
  void write(ResultFile& file) const override;

 protected:
  const Domain& box() const { return box_; }
  const BulkMedium& bulk() const { return materials().front().medium; }

 private:
  /// int relative_density() along w.
  virtual double met(Vec2 x, Vec2 w, double length) const = 0;
  virtual double most_relative() const = 0;
  /// Of the box.
  virtual double mean_relative() const = 0;

  Domain box_;
};

extern const DatasetTable density_table;

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

/// Makes a density map of a box of a material.
using MakeDensityMap =
    std::function<std::shared_ptr<const MediumProfile>(const Domain&, const Material&)>;

/// That which the keys density_blobs and density_map name; empty without. Reads keys and files.
/// Throws InputError.
MakeDensityMap density_map(const Keys& keys, const SceneSpec& spec);

}  // namespace flatspeckle

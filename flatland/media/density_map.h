#pragma once

#include "core/result/dataset_row.h"
#include "flatland/media/medium_profile.h"

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

}  // namespace flatspeckle

#pragma once

#include "core/result/dataset_row.h"
#include "flatland/media/medium_profile.h"

namespace flatspeckle {

/// Layers on top of each other, from z = 0 on, each of one material.
class Layers : public MediumProfile {
 public:
  /// One of each material, none thinner than 0.
  Layers(std::vector<Material> materials, const std::vector<double>& thicknesses);

  /// Of the layers' faces, from 0 on.
  const std::vector<double>& faces() const { return faces_; }
  double thickness(std::size_t layer) const { return faces_[layer + 1] - faces_[layer]; }

  std::size_t material_at(Vec2 x) const override;
  double relative_density(Vec2) const override { return 1; }
  double most_density() const override;
  double optical_depth(Vec2 x, Vec2 w, double length) const override;
  double reach(Vec2 x, Vec2 w, double optical_depth, double longest) const override;
  BulkMedium mean() const override;
  void write(ResultFile& file) const override;
  std::string describe() const override;

 private:
  double mu(std::size_t layer) const { return materials()[layer].medium.mu_t; }
  double depth_at(double z) const;

  std::vector<double> faces_;
  std::vector<double> depths_;  ///< optical, of the faces
};

extern const DatasetTable layers_table;

}  // namespace flatspeckle

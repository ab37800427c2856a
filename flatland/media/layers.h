#pragma once

#include <algorithm>

#include "core/result/dataset_row.h"
#include "flatland/media/medium_profile.h"

namespace flatspeckle {

/// Stack of homogeneous layers, each of one material. The first layer begins at z = 0.
class Layers : public MediumProfile {
 public:
  /// Creates one layer of each material. No thickness may be negative.
  Layers(std::vector<Material> materials, const std::vector<double>& thicknesses);

  /// Returns the z coordinates of the layers' faces. The first is 0.
  const std::vector<double>& faces() const { return faces_; }
  double thickness(std::size_t layer) const { return faces_[layer + 1] - faces_[layer]; }

  /// Calls f(layer, length) for each layer that the straight path from x along w crosses, with the
  /// length of the path in that layer.
  template <typename F>
  void each_part(Vec x, Vec w, double length, const F& f) const {
    double gone = 0;
    for (auto layer = material_at(x);; w.z > 0 ? ++layer : --layer) {
      const double face = w.z > 0 ? faces_[layer + 1] : faces_[layer],
                   to_face = w.z == 0 ? length : std::min(length, (face - x.z) / w.z);
      const bool last = w.z > 0 ? layer + 2 == faces_.size() : layer == 0;
      f(layer, std::max(0.0, (last ? length : to_face) - gone));
      gone = std::max(gone, to_face);
      if (last || gone >= length) return;
    }
  }

  std::size_t material_at(Vec x) const override;
  double relative_density(Vec) const override { return 1; }
  double most_density() const override;
  double optical_depth(Vec x, Vec w, double length) const override;
  double reach(Vec x, Vec w, double optical_depth, double longest) const override;
  std::shared_ptr<const MediumProfile> with(std::vector<Material> materials) const override;
  BulkMedium mean() const override;
  void write(ResultFile& file) const override;
  std::string describe() const override;

 private:
  double mu(std::size_t layer) const { return materials()[layer].medium.mu_t; }
  double depth_at(double z) const;

  std::vector<double> faces_;
  std::vector<double> depths_;  ///< optical depth from z = 0 to each face
};

extern const DatasetTable layers_table;

}  // namespace flatspeckle

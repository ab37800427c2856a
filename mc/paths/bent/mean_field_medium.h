#pragma once

#include "mc/paths/bent/graded_medium.h"

namespace flatspeckle::mc {

/// A medium whose mean field is refracted: of index n = 1 + k_shift/k, with attenuation in sigma as
/// in other media of an index (C31), K^2 = k^2 n^2 + i k mu_t. Plane waves come into a slab by
/// Snell and Fresnel, to leading order in the reflection; into a box as the field of the
/// homogenised box (homogenised_box.h). Flights between scatterers are straight and end at the
/// edge.
class MeanFieldMedium : public GradedMedium {
 public:
  explicit MeanFieldMedium(const Scene& scene)
      : domain_(scene.domain),
        k_(scene.k),
        mu_t_(scene.medium.mu_t),
        index_(1 + scene.medium.k_shift / scene.k) {}

  double square(Vec2) const override { return index_ * index_; }
  double inside(Vec2 x, Vec2 w) const override { return domain_.distance_to_edge(x, w) / index_; }
  std::optional<RayPlace> flown(Vec2 x, Vec2 w, double sigma) const override;

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec2 source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;

  Domain domain_;
  double k_, mu_t_, index_;
};

}  // namespace flatspeckle::mc

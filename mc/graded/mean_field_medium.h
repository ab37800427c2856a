#pragma once

#include "mc/graded/graded_medium.h"

namespace flatspeckle::mc {

/// A medium whose mean field is refracted: waves travel with K = k + k_shift + i mu_t / 2 (C15) in
/// the end factors, between scatterers with k as ever. In a slab by Snell and Fresnel, to leading
/// order in the reflection; in a box by the field of the homogenised box (homogenised_box.h).
class MeanFieldMedium : public GradedMedium {
 public:
  explicit MeanFieldMedium(const Scene& scene)
      : domain_(scene.domain),
        k_(scene.k),
        mu_t_(scene.medium.mu_t),
        index_(1 + scene.medium.k_shift / scene.k) {}

  double square(Vec2) const override { return 1; }
  double inside(Vec2 x, Vec2 w) const override { return domain_.distance_to_edge(x, w); }
  std::optional<RayPlace> flown(Vec2 x, Vec2 w, double sigma) const override;

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec2 source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;

  Domain domain_;
  double k_, mu_t_, index_;
};

}  // namespace flatspeckle::mc

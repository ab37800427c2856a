#pragma once

#include "flatland/media/density_map.h"

namespace flatspeckle {

/// A Gaussian of the relative density, amplitude exp(-r^2 / (2 radius^2)); a hole where the
/// amplitude is negative.
struct Blob {
  Vec2 centre;
  double radius = 1, amplitude = 0;
};

/// Relative density 1 and Gaussian blobs. What a way meets is in closed form.
class Blobs : public DensityMap {
 public:
  /// The density must be positive everywhere: negative amplitudes add up to -1 at the most.
  Blobs(Domain box, Material material, std::vector<Blob> blobs);

  double relative_density(Vec2 x) const override;
  std::string describe() const override;

 private:
  double met(Vec2 x, Vec2 w, double length) const override;
  double most_relative() const override;
  double mean_relative() const override;

  std::vector<Blob> blobs_;
};

}  // namespace flatspeckle

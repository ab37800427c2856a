#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "flatland/media/domain.h"
#include "mc/paths/bent/graded_medium.h"
#include "mc/paths/endpoint_factors/endpoint_factors.h"

namespace flatspeckle::mc {

/// Returns per_side points on each side of a box, in order around the box. The first point of each
/// side is a corner.
inline std::vector<Vec> edge_places(const Domain& box, std::size_t per_side) {
  const double half = box.width / 2;
  const Vec corners[] = {{-half, 0}, {half, 0}, {half, box.depth}, {-half, box.depth}};
  std::vector<Vec> places;
  for (std::size_t side = 0; side < 4; ++side)
    for (std::size_t i = 0; i < per_side; ++i) {
      const Vec from = corners[side], to = corners[(side + 1) % 4];
      places.push_back(from + static_cast<double>(i) / static_cast<double>(per_side) * (to - from));
    }
  return places;
}

/// Endpoint factors (conventions, C13) for curved rays, by C32 and C33.
class GradedEndpoints : public EndpointFactors {
 public:
  GradedEndpoints(const Scene& scene, const std::vector<Endpoint>& endpoints, bool phases,
                  const GradedMedium& medium);

  void attenuate(Vec x, std::span<Complex> out) override;

 private:
  struct Towards {
    /// Wave from the endpoint; by reciprocity it also gives the wave that reaches the endpoint
    std::shared_ptr<const Wavefront> wave;
    bool near;
    Complex strength;
  };

  double k_, mu_t_;
  bool phases_;
  std::vector<Towards> endpoints_;
  std::vector<double> phase_, log_magnitude_;
};

/// Throws InputError unless every endpoint has exactly one ray to every place of the domain.
void check_graded_endpoints(const Scene& scene, const GradedMedium& medium);

}  // namespace flatspeckle::mc

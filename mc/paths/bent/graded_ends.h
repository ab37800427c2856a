#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "flatland/media/domain.h"
#include "mc/paths/bent/graded_medium.h"
#include "mc/paths/endpoint_factors/end_factors.h"

namespace flatspeckle::mc {

/// So many places along each side of a box, round about it; each side begins at a corner.
inline std::vector<Vec2> edge_places(const Domain& box, std::size_t per_side) {
  const double half = box.width / 2;
  const Vec2 corners[] = {{-half, 0}, {half, 0}, {half, box.depth}, {-half, box.depth}};
  std::vector<Vec2> places;
  for (std::size_t side = 0; side < 4; ++side)
    for (std::size_t i = 0; i < per_side; ++i) {
      const Vec2 from = corners[side], to = corners[(side + 1) % 4];
      places.push_back(from + static_cast<double>(i) / static_cast<double>(per_side) * (to - from));
    }
  return places;
}

/// End factors where light is bent (conventions, C32).
class GradedEnds : public EndFactors {
 public:
  GradedEnds(const Scene& scene, const std::vector<End>& ends, bool phases,
             const GradedMedium& medium);

  void attenuate(Vec2 x, std::span<Complex> out) override;

 private:
  struct Towards {
    std::shared_ptr<const Wavefront> wave;  ///< from the end; by reciprocity that towards it
    bool near;
    Complex strength;
  };

  double k_, mu_t_;
  bool phases_;
  std::vector<Towards> ends_;
  std::vector<double> phase_, log_magnitude_;
};

/// Every end has one ray to every place. Throws InputError.
void check_graded_ends(const Scene& scene, const GradedMedium& medium);

}  // namespace flatspeckle::mc

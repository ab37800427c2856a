#pragma once

#include <memory>
#include <span>
#include <vector>

#include "mc/paths/bent/graded_medium.h"
#include "mc/paths/endpoint_factors/end_factors.h"

namespace flatspeckle::mc {

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

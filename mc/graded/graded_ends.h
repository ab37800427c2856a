#pragma once

#include <memory>
#include <span>
#include <vector>

#include "mc/graded/graded_scattering.h"

namespace flatspeckle::mc {

/// End factors (end_factors.h) where light is bent (conventions, C32).
template <bool phases>
class GradedEnds {
 public:
  GradedEnds(const Scene& scene, const std::vector<End>& ends, const GradedMedium& medium);

  std::size_t size() const { return ends_.size(); }

  void at(Vec2 x, Vec2 arrival, const GradedScattering& scattering, std::span<Complex> out) {
    attenuate(x, out);
    scattering.form().towards(arrival, directions_, out);
  }
  void attenuate(Vec2 x, std::span<Complex> out);

  Vec2 direction(std::size_t j) const { return directions_[j]; }
  const Directions& directions() const { return directions_; }

 private:
  struct Towards {
    std::shared_ptr<const Wavefront> wave;  ///< from the end; by reciprocity that towards it
    bool near;
    Complex strength;
  };

  double k_, mu_t_;
  std::vector<Towards> ends_;
  Directions directions_;
  std::vector<double> phase_, log_magnitude_;
};

/// Every end has one ray to every place. Throws InputError.
void check_graded_ends(const Scene& scene, const GradedMedium& medium);

}  // namespace flatspeckle::mc

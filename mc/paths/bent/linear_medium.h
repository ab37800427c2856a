#pragma once

#include "mc/paths/bent/graded_medium.h"

namespace flatspeckle::mc {

/// n^2 linear: rays are parabolas, and all is in closed form. Of two curves between two points the
/// direct one counts: the other comes back from where n^2 is small.
class LinearMedium : public GradedMedium {
 public:
  LinearMedium(const Domain& domain, const IndexField& field)
      : domain_(domain), field_(field), force_(0.5 * field.slope) {}

  double square(Vec2 x) const override { return field_.square(x); }
  double inside(Vec2 x, Vec2 w) const override;
  std::optional<RayPlace> flown(Vec2 x, Vec2 w, double sigma) const override;

  std::optional<RayCurve> curve(Vec2 from, Vec2 to) const;
  /// sigma in the domain, up to so far along a ray of velocity v.
  double inside_until(Vec2 x, Vec2 v, double sigma) const;
  const Domain& domain() const { return domain_; }
  double slope() const { return field_.slope.z; }  ///< along z

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec2 source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;
  Vec2 velocity(Vec2 x, Vec2 w) const;
  double end_of(Vec2 x, Vec2 v) const;  ///< of a ray

  Domain domain_;
  IndexField field_;
  Vec2 force_;
};

}  // namespace flatspeckle::mc

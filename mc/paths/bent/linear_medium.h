#pragma once

#include "mc/paths/bent/graded_medium.h"

namespace flatspeckle::mc {

/// Medium in which n^2 is linear in position, so that rays are parabolas and everything has a
/// closed form. Of the two rays between two points only the direct ray is used, not the ray that
/// returns from where n^2 is small.
class LinearMedium : public GradedMedium {
 public:
  LinearMedium(const Domain& domain, const IndexField& field)
      : domain_(domain), field_(field), force_(0.5 * field.gradient) {}

  double square(Vec2 x) const override { return field_.square(x); }
  double inside(Vec2 x, Vec2 w) const override;
  std::optional<RayPlace> after_flight(Vec2 x, Vec2 w, double sigma) const override;

  std::optional<RayCurve> curve(Vec2 from, Vec2 to) const;
  /// Returns how much of the interval from 0 to `sigma` of the ray from x with velocity v =
  /// dx/dsigma (C30) lies in the domain.
  double inside_until(Vec2 x, Vec2 v, double sigma) const;
  const Domain& domain() const { return domain_; }
  double derivative_along_z() const { return field_.gradient.z; }  ///< d(n^2)/dz

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec2 source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;
  Vec2 velocity(Vec2 x, Vec2 w) const;
  double end_of(Vec2 x, Vec2 v) const;  ///< sigma at which the ray from x with velocity v ends

  Domain domain_;
  IndexField field_;
  Vec2 force_;
};

}  // namespace flatspeckle::mc

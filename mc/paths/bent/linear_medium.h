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

  double square(Vec x) const override { return field_.square(x); }
  double inside(Vec x, Vec w) const override;
  std::optional<RayPlace> after_flight(Vec x, Vec w, double sigma) const override;

  std::optional<RayCurve> curve(Vec from, Vec to) const;
  /// Returns how much of the interval from 0 to `sigma` of the ray from x with velocity v =
  /// dx/dsigma (C30) lies in the domain.
  double inside_until(Vec x, Vec v, double sigma) const;
  const Domain& domain() const { return domain_; }
  double derivative_along_z() const { return field_.gradient.z; }  ///< d(n^2)/dz

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;
  Vec velocity(Vec x, Vec w) const;
  double end_of(Vec x, Vec v) const;  ///< sigma at which the ray from x with velocity v ends

  Domain domain_;
  IndexField field_;
  Vec force_;
};

}  // namespace flatspeckle::mc

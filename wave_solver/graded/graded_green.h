#pragma once

#include <optional>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/index_field.h"

namespace flatspeckle::wave {

/// The Green function (laplacian + k^2 n^2) G = -delta where n^2 is linear or parabolic
/// (conventions, C34), without what comes back from where n^2 = 0, or after a focus: the integral
/// over the propagator's time along a contour through the saddle of the direct ray, to rounding.
class GradedGreen {
 public:
  /// longest: distance between any two points that it will be asked for. Throws InputError for
  /// other fields.
  GradedGreen(const IndexField& field, double k, double longest);

  /// Throws InputError where the direct wave is not a function of its own: no ray joins the points,
  /// or what comes back is as near.
  Complex operator()(Vec2 p, Vec2 q) const;

 private:
  std::optional<double> sigma(Vec2 p, Vec2 q) const;  ///< of the direct ray (C32)
  [[noreturn]] void refuse(Vec2 p, Vec2 q) const;

  IndexField field_;
  double k_, step_;
  /// The contour t = t0 time[j] from the saddle t0 upwards, and t0 / time[j] downwards.
  std::vector<Complex> time_, weight_;
};

}  // namespace flatspeckle::wave

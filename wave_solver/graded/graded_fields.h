#pragma once

#include <optional>
#include <vector>

#include "core/numbers/complex.h"
#include "core/result/dataset_row.h"
#include "flatland/media/index_field.h"
#include "flatland/scene/scene.h"

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

/// Exact fields of point scatterers where the index varies: Foldy and Lax's equations, coupled by
/// the medium's own Green function (conventions, C31 and C34). Point sources, near sensors.
class GradedFields {
 public:
  /// within: places that the scatterers lie between. Throws InputError for other fields than
  /// GradedGreen has, and where it would not have all of it.
  GradedFields(const IndexField& field, double k, std::vector<Vec2> sources,
               std::vector<Vec2> sensors, const std::vector<Vec2>& within);

  /// Scattered field of a placement, [light][view]. Throws InputError as GradedGreen does.
  std::vector<Complex> of(const Placement& placement) const;

 private:
  std::vector<Complex> rows(const Placement& placement, const std::vector<Vec2>& points) const;

  double k_;
  std::vector<Vec2> sources_, sensors_;
  GradedGreen green_;
};

/// Of a scene in a box. Throws InputError for other lights and views too.
GradedFields graded_fields(const Scene& scene);

extern const DatasetTable graded_table;

}  // namespace flatspeckle::wave

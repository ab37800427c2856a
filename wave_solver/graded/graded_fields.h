#pragma once

#include <optional>
#include <vector>

#include "core/numbers/complex.h"
#include "core/result/dataset_row.h"
#include "flatland/media/index_field.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::wave {

/// The Green function of a linear or parabolic n^2, (laplacian + k^2 n^2) G = -delta (conventions,
/// C34). It does not contain waves that return from where n^2 = 0 or after a focus. It is computed,
/// accurate to rounding, as the integral over the time of the propagator along a contour through
/// the saddle point of the direct ray.
class GradedGreen {
 public:
  /// longest: upper bound of the distance between the two points of an evaluation. Throws
  /// InputError if n^2 is neither linear nor parabolic.
  GradedGreen(const IndexField& field, double k, double longest);

  /// Returns G for the points p and q. Throws InputError if the direct wave cannot be separated
  /// from returning waves, or if no ray connects the points.
  Complex operator()(Vec p, Vec q) const;

 private:
  std::optional<double> sigma(Vec p, Vec q) const;  ///< parameter of the direct ray (C32)
  [[noreturn]] void refuse(Vec p, Vec q) const;

  IndexField field_;
  double k_, step_;
  /// Integration contour through the saddle point t0: points t0 time[j] on one side and t0 /
  /// time[j] on the other, with quadrature weights for dt/t.
  std::vector<Complex> time_, weight_;
};

/// Exact fields of point scatterers in a medium of varying index, by the Foldy-Lax equations with
/// the Green function of that medium (conventions, C31 and C34). Lights are point sources, and
/// views are near sensors.
class GradedFields {
 public:
  /// within: corners of the region that contains the scatterers. Throws InputError for index fields
  /// that GradedGreen does not support, and if GradedGreen cannot compute the direct wave between a
  /// corner and another corner, a source or a sensor.
  GradedFields(const IndexField& field, double k, std::vector<Vec> sources,
               std::vector<Vec> sensors, const std::vector<Vec>& within);

  /// Returns the scattered field of a placement, [light][view]. Throws under the conditions of
  /// GradedGreen.
  std::vector<Complex> of(const Placement& placement) const;

 private:
  std::vector<Complex> rows(const Placement& placement, const std::vector<Vec>& points) const;

  double k_;
  std::vector<Vec> sources_, sensors_;
  GradedGreen green_;
};

/// Returns the GradedFields of a scene in a box. Throws InputError under the conditions of
/// GradedFields, and if a light is not a point source or a view is not a near sensor.
GradedFields graded_fields(const Scene& scene);

extern const DatasetTable graded_table;

}  // namespace flatspeckle::wave

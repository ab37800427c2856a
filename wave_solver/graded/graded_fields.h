#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "core/result/dataset_row.h"
#include "flatland/scene/scene.h"
#include "wave_solver/graded/graded_green.h"

namespace flatspeckle::wave {

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

#pragma once

#include <memory>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"
#include "flatland/scene/scene.h"
#include "wave_solver/layered/layer_green.h"

namespace flatspeckle::wave {

/// Exact fields of point scatterers in a layer with reflecting faces, by the Foldy-Lax equations
/// with the Green function of the layer (conventions, C51). Lights are plane waves and views are
/// directions, both outside the layer. The scattered field is the total field without that of the
/// empty layer.
class LayerFields {
 public:
  /// width: upper bound of |x - x'| between scatterers. Throws InputError under the conditions of
  /// LayerGreen.
  LayerFields(const LayerWaves& waves, double width, std::vector<double> light_angles,
              std::vector<double> view_angles);

  /// Returns the far-field amplitudes (C4) of a placement, [light][view], with phase origin r = 0.
  std::vector<Complex> of(const Placement& placement) const;

 private:
  LayerGreen green_;
  std::vector<double> light_angles_, view_angles_;
};

/// Returns the LayerFields of a scene with faces. Throws InputError under the conditions of
/// LayerFields, and if the scatterers are not points.
LayerFields layer_fields(const Scene& scene);

}  // namespace flatspeckle::wave

#pragma once

#include <span>
#include <vector>

#include "mc/fit/task/measurement.h"

namespace flatspeckle::mc {

/// A scene of the plane or, with dimension = 3, of space. Throws InputError.
Scene scene_of(const SceneSpec& spec);

/// What a curve is of: its scene, made, and its motion.
struct Medium {
  MovingSpec spec;
  Scene scene;

  explicit Medium(const MovingSpec& of) : spec(of), scene(scene_of(of)) {}
};
using Media = std::vector<Medium>;  ///< of all curves

bool is_flux(Observable observable);

/// Reversed paths add about 1 / (k l* angle) of what is seen at this angle from backscattering:
/// whether that is a thousandth or more in some view.
bool needs_reversed(const Scene& scene);

/// The scene of some curves, the first's, with the channels and entries of all as pairs.
Scene joint_scene(const Media& media, const std::vector<std::size_t>& curves);

/// Those of a curve, of the covariance entries of its request, [0 and its delays][entry]. beta: K^2
/// of still scatterers.
std::vector<double> observed(const Curve& curve, double beta, const CovarianceRequest& request,
                             std::span<const Complex> entries);

}  // namespace flatspeckle::mc

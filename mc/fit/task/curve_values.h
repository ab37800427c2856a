#pragma once

#include <span>
#include <vector>

#include "mc/fit/task/measurement.h"

namespace flatspeckle::mc {

/// Makes a scene in the plane or, with dimension = 3, in space. Throws InputError.
Scene scene_of(const SceneSpec& spec);

/// The medium of a curve: its scene and the motion of its scatterers.
struct Medium {
  MovingSpec spec;
  Scene scene;

  explicit Medium(const MovingSpec& of) : spec(of), scene(scene_of(of)) {}
};
using Media = std::vector<Medium>;  ///< the medium of each curve

bool is_flux(Observable observable);

/// Whether reversed paths contribute a thousandth or more in some detection direction. At an angle
/// from exact backscattering they contribute about 1 / (k l* angle), with the transport mean free
/// path l*.
bool needs_reversed(const Scene& scene);

/// Returns the scene of the first given curve with one request of kind pairs, which contains the
/// channels and entries of all given curves.
Scene joint_scene(const Media& media, const std::vector<std::size_t>& curves);

/// Returns the values of a curve from the covariances of its request, [time][entry], at time 0 and
/// after each delay of the curve. beta: squared contrast K^2 of the speckle of static scatterers.
std::vector<double> observed(const Curve& curve, double beta, const CovarianceRequest& request,
                             std::span<const Complex> entries);

}  // namespace flatspeckle::mc

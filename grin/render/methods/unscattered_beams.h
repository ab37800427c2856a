#pragma once

#include <memory>

#include "grin/render/flights/space.h"
#include "grin/render/methods/moving_field.h"
#include "grin/render/methods/path_kernels.h"

namespace flatspeckle::grin {

// Unscattered light of beams that reaches the sensors. Path estimators leave it out
// (Bidirectional), and it is estimated separately, with its transmittance as weight instead of
// sampled collisions. Two strategies are combined. Rays start at points spread evenly over the
// beams: a golden-ratio lattice in the unit square, which becomes a spiral on the disk, shifted at
// random for each batch. Connections lead from the sensors back to the beams (beam_search.cpp);
// they also reach pinholes, and find glints in a small lens.
//
// The functions require the space of without_scattering(stage), in which each flight ends on the
// boundary.

struct BeamsRequest {
  bool random_phase = false;   ///< each ray has a random phase of the sound
  bool tallies_power = false;  ///< whether rays tally the power of beams, since no paths do
  bool connects = true;        ///< whether sensors are also connected to the beams
  /// Set if derivatives by parameters of the field are requested (gradient_by).
  std::shared_ptr<const MovingField> moving = nullptr;
};

/// Adds rays, each of which represents paths_per_ray light paths.
using BeamsKernel = std::function<void(int rays, double paths_per_ray, RandomStream& random,
                                       Film& film, TransportCounts& counts)>;

BeamsKernel beams_kernel(const BeamsRequest& request, std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space);

/// Returns the number of rays per path of forward tracing (forward_light.h). It decreases with the
/// unscattered fraction of the light. At most one ray per path is needed: rays are stratified, so
/// that their error decreases faster with their number than that of paths.
double rays_beside_path(const StageLights& lights, const Space& space);

/// Returns the fraction of the beams' light that hits the sensor that gets the least of it.
double fraction_that_hits(const Transport& transport, const Space& space);

/// Whether there are beams, and a sensor that their rays can hit.
bool are_followed(const Transport& transport);

}  // namespace flatspeckle::grin

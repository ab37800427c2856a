#pragma once

#include <memory>

#include "grin/render/flights/space.h"
#include "grin/render/methods/moving_field.h"
#include "grin/render/methods/path_kernels.h"

namespace flatspeckle::grin {

// The light of beams that reaches the sensor without a collision. Walks leave it out
// (Bidirectional), and it is summed apart: with its transmittance instead of by chance, by rays
// from points spread evenly over the beams (in a square a lattice of the golden ratio, on a disk
// its spiral; shifted at random for each batch), and by ways from the sensors back to the beams
// (beam_search.cpp), which find a pinhole and the glints in a small lens.
//
// The space is that of without_scattering(stage), where each flight goes to the boundary.

struct BeamsRequest {
  bool random_phase = false;  ///< each ray meets its own phase of the sound
  bool books = false;         ///< where the power of rays goes, as nothing else does
  std::shared_ptr<const MovingField> moving =
      nullptr;  ///< where there are derivatives by its parameters
};

/// So many rays, each of which stands for `worth` light paths.
using BeamsKernel = std::function<void(int rays, double worth, RandomStream& random, Film& film,
                                       TransportCounts& counts)>;

BeamsKernel beams_kernel(const BeamsRequest& request, std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space);

/// Rays that a light path that is only counted where it hits (analog_light.h) needs beside it. The
/// less light is left to them, the fewer; as they are spread evenly, their error falls faster than
/// that of paths.
double rays_beside_path(const StageLights& lights, const Space& space);

/// Whether there are beams, and a sensor that their rays can hit.
bool are_followed(const Transport& transport);

}  // namespace flatspeckle::grin

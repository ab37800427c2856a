#pragma once

#include <string>
#include <vector>

#include "bench/error/error_measure.h"

namespace flatspeckle::bench {

/// A long run that stands for the truth; its name is that of a scene, or of a scene and a method.
struct LongRun {
  std::string name;
  std::string how;  ///< it was made, in words
  std::function<ErrorTrial(std::uint64_t seed)> trial;
};

/// From data/error_references.txt, which is compiled in: made by bench_error_table. Throws
/// std::out_of_range for a name that is not there.
ErrorReference stored_reference(const std::string& name);

/// Covariance of speckle on box_points, box_points_absorbing and box_cylinders (data/scenes), as
/// memory effect over seven tilts in transmission and reflection: the exact ensemble by the dense
/// and by the fast solver, and the methods of paths.
std::vector<ErrorRun> box_error_runs();
std::vector<LongRun> box_long_runs();

/// A slab's memory effect over seven tilts in transmission, in the plane and in space, by transport
/// without chance and by paths, its intensities for a phase function of two terms, and scatterers
/// that flow beside diffusing.
std::vector<ErrorRun> slab_error_runs();

/// What g of a slab is off by, found from exact curves that are said to have errors, the smaller
/// the longer it takes: by transport, whose ordinates grow in number, and by paths, whose number
/// does.
std::vector<ErrorRun> fit_error_runs();

/// C_I of pairs of points that pictures are predicted from, by light paths, against many more of
/// them; and patterns of sources by frames.
std::vector<ErrorRun> imaging_error_runs();

/// Path tracing, light tracing, bidirectional path tracing and the photon map on a Luneburg ball, a
/// waveguide of ultrasound, a slab and a glass ball in fog. Part of the boundary is the lamp and
/// another part the detector, so that rays can hit both: then every method but the photon map,
/// which is biased, has finite variance. Where they cannot, path tracing has none: one curve shows
/// it. A Luneburg ball in the same light from everywhere is known in closed form, and so is a ring
/// of triangles; a ball of triangles is compared with the ball of its volume.
std::vector<ErrorRun> render_error_runs();
std::vector<LongRun> render_long_runs();

/// What the index of a lens is off by (r < 0.9, root mean square) that was sought from n = 1,
/// against Luneburg's: radial profiles and splines in space of more and more coefficients, and
/// profiles by the gradient alone.
std::vector<ErrorRun> design_error_runs();

}  // namespace flatspeckle::bench

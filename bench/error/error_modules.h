#pragma once

#include <string>
#include <vector>

#include "bench/error/error_measure.h"

namespace flatspeckle::bench {

/// A long run that serves as a reference. Its name is that of the scene, or of the scene and the
/// method.
struct LongRun {
  std::string name;
  std::string how;  ///< origin of the values, in words
  std::function<ErrorTrial(std::uint64_t seed)> trial;
};

/// Returns a reference of data/error_references.txt, which bench_error_table writes and CMake
/// compiles in. Throws std::out_of_range for an unknown name.
ErrorReference stored_reference(const std::string& name);

/// Error curves of the speckle covariance in the boxes box_points, box_points_absorbing and
/// box_cylinders (data/scenes) and of such boxes in space: memory effect over seven tilts in
/// transmission and reflection. The methods are exact ensembles by the dense and the fast solver
/// (in space only the dense one, for a small box), and Monte Carlo.
std::vector<ErrorRun> box_error_runs();
std::vector<LongRun> box_long_runs();

/// Error curves of slabs: memory effect over seven tilts in transmission, in 2D and 3D, by
/// deterministic transport and by Monte Carlo; intensities for a two-term phase function;
/// correlation of scatterers that flow and diffuse.
std::vector<ErrorRun> slab_error_runs();

/// Error curves of powers: reflectance and transmittance of a slab by Monte Carlo (`flux`), power at
/// distances from a beam by deterministic transport (`reflectance`), and conductance and tilt
/// correlations of transmission matrices (`matrix`).
std::vector<ErrorRun> power_error_runs();
std::vector<LongRun> power_long_runs();

/// Error of the anisotropy g that a fit recovers from exact curves of a slab. The curves have
/// assumed errors, which are reduced from point to point. The fit uses deterministic transport with
/// more and more ordinates, or Monte Carlo with more and more paths.
std::vector<ErrorRun> fit_error_runs();

/// Error of the largest value that a search (`optimise`) finds, relative to the largest value in
/// closed form, against the target error of the search.
std::vector<ErrorRun> search_error_runs();

/// Errors of imaging through a medium: of C_I for pairs of object points, from which pictures are
/// predicted, against a run with many more paths; and of separated source patterns against the
/// number of frames.
std::vector<ErrorRun> imaging_error_runs();

/// Path tracing, light tracing, bidirectional path tracing and the photon map on a Luneburg ball,
/// an ultrasound waveguide, a slab and a glass ball in fog. Part of the boundary is the lamp and
/// another part the detector, so that rays can hit both; then all methods but the biased photon map
/// have finite variance. Where rays cannot hit the lamp, path tracing has infinite variance, as one
/// curve shows. A Luneburg ball and a ring of triangles in isotropic illumination have a closed
/// form; a ball of triangles is compared with a sphere of equal volume.
std::vector<ErrorRun> render_error_runs();
std::vector<LongRun> render_long_runs();

/// RMS difference between the index of a lens, designed from the start n = 1, and Luneburg's index,
/// for r < 0.9. The lens is a radial profile or a spline in space with increasing numbers of
/// coefficients; radial profiles are also searched by methods that use only the gradient.
std::vector<ErrorRun> design_error_runs();

/// RMS error of the normals of a ball of more and more triangles, which are taken as curved or as
/// plane.
std::vector<ErrorRun> lens_error_runs();

}  // namespace flatspeckle::bench

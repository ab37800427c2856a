#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// The exact solver as batches for the runner: batch = one placement drawn with (seed, number) and
/// solved for the lights of the request. Sums are [channel] u, then [entry] u_a conj(u_b); mean and
/// covariance are read from them with the sample mean removed, unbiased (C12).
/// tolerance: of every placement's fields (SolveOptions).
/// Throws InputError for a slab and the bulk, which have no finite placement and no T-matrix, and
/// for near sensors and sources that a cylinder may cover, and where the matrices of all threads
/// surely need more memory than there is.
FieldJob wave_job(const Scene& scene, std::uint64_t seed, double tolerance,
                  Method method = Method::automatic);

/// Returns the covariance of each entry from such sums; 0 while one sample shows no spread.
std::vector<Complex> placement_covariance(const CovarianceRequest& request, double samples,
                                          std::span<const Complex> sums);

/// The same, each placement solved at shifted frequencies too (conventions, C39; checked by
/// check_frequency_shifts()). all: the entries, then those with the second field at each shifted
/// frequency, [1 + shift][entry], 0 where entries do not change. Disks and points keep radius,
/// index and phase shift.
struct FrequencyJob {
  FieldJob field;
  Estimator all;
};
FrequencyJob frequency_job(const Scene& scene, const std::vector<double>& shifts,
                           std::uint64_t seed, double tolerance, Method method = Method::automatic);

}  // namespace flatspeckle::wave

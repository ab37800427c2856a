#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// Makes the job of the exact solver for the runner. A batch is one placement, drawn with the
/// random numbers of (seed, batch number) and solved for the lights of the request. It adds to the
/// sums the field u of each channel, then u_a conj(u_b) of each entry. Estimates of mean and
/// covariance from these sums are unbiased (C12). tolerance: error of every placement's fields
/// (SolveOptions). Throws InputError for a slab, which has no finite placement; for phase functions
/// of the bulk, which have no T-matrix; for near sensors and sources that a cylinder may cover;
/// for scatterers other than points and tolerances below LayerGreen::accuracy if faces reflect; and
/// if the matrices of all threads certainly exceed the available memory.
FieldJob wave_job(const Scene& scene, std::uint64_t seed, double tolerance,
                  Method method = Method::automatic);

/// Returns the covariance of each entry from the sums of wave_job(); 0 for fewer than two samples.
std::vector<Complex> placement_covariance(const CovarianceRequest& request, double samples,
                                          std::span<const Complex> sums);

/// Job that also solves each placement at shifted frequencies (conventions, C39), which
/// check_frequency_shifts() must accept. all: estimates the covariances [1 + shift][entry], first
/// without a shift, then with the second field at each shifted frequency; 0 for entries beyond
/// changing_entries(). Disks and points keep their radius, index and phase shift.
struct FrequencyJob {
  FieldJob field;
  Estimator all;
};
FrequencyJob frequency_job(const Scene& scene, const std::vector<double>& shifts,
                           std::uint64_t seed, double tolerance, Method method = Method::automatic);

}  // namespace flatspeckle::wave

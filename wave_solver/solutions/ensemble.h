#pragma once

#include <cstdint>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::wave {

/// The exact solver as batches for the runner: batch = one placement drawn with (seed, number) and
/// solved for the lights of the request. Sums are [channel] u, then [entry] u_a conj(u_b); mean and
/// covariance are read from them with the sample mean removed, unbiased (C12).
/// tolerance: of every placement's fields (SolveOptions).
/// Throws InputError for a slab and the bulk, which have no finite placement and no T-matrix, and
/// for near sensors and sources that a cylinder may cover, and where the matrices of all threads
/// surely need more memory than there is.
FieldJob wave_job(const Scene& scene, std::uint64_t seed, double tolerance);

}  // namespace flatspeckle::wave

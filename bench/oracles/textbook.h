#pragma once

#include <cstdint>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::oracles {

/// The published Monte Carlo estimator of the covariance (Bar, Alterman, Gkioulekas, Levin 2019,
/// algorithm 1), written from the paper in plain code: the oracle of the tests and the baseline of
/// the benchmarks. A light of the request at random, the first scatterer by its attenuation inside
/// the medium, the first direction by the phase function, free flights that may leave, albedo
/// weights with roulette below 0.2; every scatterer of the path is joined to all views and a full
/// rank-one update made for the requested entries.
/// reversed: f = F + R with the weight 1/2 of C14 and the density of the forward walk alone.
/// Far views and independent scatterers only.
FieldJob textbook_job(const Scene& scene, bool reversed, std::uint64_t paths_per_batch,
                      std::uint64_t seed);

}  // namespace flatspeckle::oracles

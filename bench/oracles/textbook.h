#pragma once

#include <cstdint>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::oracles {

/// The published Monte Carlo estimator of the covariance (Bar, Alterman, Gkioulekas, Levin
/// [bar2019], algorithm 1), written in plain code from the paper. It is a reference for the tests
/// and a baseline for the benchmarks. It picks an illumination of the request at random and samples
/// the first scatterer in proportion to the attenuated intensity inside the medium, and the first
/// direction from the phase function. Free flights may leave the medium; paths carry albedo
/// weights, with Russian roulette below 0.2. Every scatterer of the path is connected to all
/// detection directions, with a full rank-one update of the requested entries. With `reversed`,
/// each contribution is f = F + R with the weight 1/2 of C14, and the density is that of the
/// forward walk alone. Only for far-field detection and independent scatterers.
FieldJob textbook_job(const Scene& scene, bool reversed, std::uint64_t paths_per_batch,
                      std::uint64_t seed);

}  // namespace flatspeckle::oracles

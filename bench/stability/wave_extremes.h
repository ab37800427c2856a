#pragma once

#include <numbers>
#include <vector>

#include "bench/scenes/standard_scenes.h"
#include "bench/stability/extreme_rows.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::bench {

using namespace wave;
using Kind = Scatterer::Kind;

using std::numbers::pi;
inline const std::vector<double> two_lights{0.3, 1.4 + pi};

inline SolveOptions to(double tolerance, Method method = Method::automatic) {
  return {.tolerance = tolerance, .sensors = {}, .diagnose = false, .method = method};
}

/// Returns the deviation |found - expected| / |expected| with its limit.
inline Finding off(Complex found, Complex expected, double limit) {
  return {std::abs(found - expected) / std::abs(expected), limit};
}

/// Compares amplitudes before and after exchanging illumination and detection directions.
Finding reciprocity(const Placement& placement, const SolveOptions& options, double limit);

std::vector<View> views_around();

/// Returns the far-field amplitude for a sum of T-matrix elements.
Complex far_amplitude(Complex sum);

}  // namespace flatspeckle::bench

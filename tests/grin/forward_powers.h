#pragma once

#include <cmath>

#include "grin/render/pictures/render_datasets.h"
#include "tests/grin/render_tests.h"

namespace flatspeckle::grin::tests {

/// A rendering by forward tracing, with its state and result.
struct Powers {
  RenderJob job;
  RunState state;
  SensorResult found;
};
inline Powers powers(const RenderScene& scene, double samples) {
  const RenderJob job = render_job(scene, {RenderMethod::forward}, 1);
  const RunState state = run_render(job, samples);
  return {job, state, render_result(scene, job, state.sums)[0]};
}

struct DerivativeEstimate {
  double value, error;
};
/// Returns the difference quotient of `power` between two runs with the same random numbers, whose
/// parameter differs by `apart`. Its error is from the scatter over groups of samples. power:
/// function of the sums of a group and the number of sums per pixel.
template <class Power>
DerivativeEstimate difference(const Powers& high, const Powers& low, double apart,
                              const Power& power) {
  const auto of_group = [&](const Powers& one, std::size_t group) {
    return power(one.state.sums.group_sums(group), static_cast<std::size_t>(one.job.bins.sums())) /
           one.state.sums.group_samples(group);
  };
  const std::size_t groups = high.state.sums.groups();
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < groups; ++i) {
    const double one = (of_group(high, i) - of_group(low, i)) / apart;
    mean += one / static_cast<double>(groups);
    square += one * one / static_cast<double>(groups);
  }
  return {mean, std::sqrt((square - mean * mean) / static_cast<double>(groups - 1))};
}

}  // namespace flatspeckle::grin::tests

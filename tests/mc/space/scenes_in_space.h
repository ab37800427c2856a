#pragma once

#include <vector>

#include "mc/slab/adding/space.h"
#include "mc/slab/slab_covariance.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::tests {

/// Returns a slab of Henyey-Greenstein scatterers; the wavelength is 1.
inline SceneSpec hg_in_space(double depth, double optical_depth, double g, double albedo) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.scatterer = "hg";
  spec.depth = depth;
  spec.optical_depth = optical_depth;
  spec.g = g;
  spec.albedo = albedo;
  return spec;
}

inline Scene in_space(const SceneSpec& spec, const CovarianceRequest& request) {
  Scene scene = mc::in_space(make_scene(spec), spec);
  scene.request = request;
  return scene;
}

inline Refined by_transport(const Scene& scene, bool reversed, double tolerance) {
  return slab_covariance(scene, reversed, {tolerance});
}

/// Pairs a light and a view with both tilted by transverse momenta q; q = 0 gives the intensity.
inline CovarianceRequest tilted_pairs(double light, double view, const std::vector<double>& q) {
  const auto deflected = [](double angle, double by) {
    const double turned = std::asin(std::sin(angle) + by / (2 * pi));
    return std::cos(angle) > 0 ? turned : pi - turned;
  };
  std::vector<AnglePair> pairs;
  for (const double by : q)
    pairs.push_back({light, view, deflected(light, by), deflected(view, by)});
  return pairs_request(pairs);
}

/// Checks that Monte Carlo and transport agree within four standard errors, each of which must be
/// below `largest_error` times the first entry.
inline void check_agreement(const Scene& scene, bool reversed, std::uint64_t paths,
                            double largest_error) {
  const auto walked = run(scene, reversed ? ReversedPaths::yes : ReversedPaths::no, paths, 1);
  const Estimate found = walked.entries();
  const auto expected = by_transport(scene, reversed, largest_error / 20).value;
  for (std::size_t e = 0; e < expected.size(); ++e) {
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected[e], 0);
    CHECK(found.error[e] < largest_error * std::abs(expected[0]));
  }
}

}  // namespace flatspeckle::mc::tests

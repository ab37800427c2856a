#pragma once

#include <cmath>
#include <random>

#include "mc/slab/slab_covariance.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::tests {

inline constexpr double wavenumber = 2 * pi;

/// Returns the angle whose k sin is larger by q, on the same side of the medium.
inline double deflected(double angle, double q) {
  const double turned = std::asin(std::sin(angle) + q / wavenumber);
  return std::cos(angle) > 0 ? turned : pi - turned;
}

/// Parameter ranges of random slabs.
struct SlabRanges {
  double thinnest = 0.3, thickest = 30;  ///< optical depths
  double least_g = -0.5, largest_g = 0.95;
};

/// Draws slabs of Henyey-Greenstein scatterers (albedo above 0.5) or cylinders, and pairs of
/// channels: intensities, small and large tilts, in transmission and reflection, near exact
/// backscattering and far from it.
class RandomSlab {
 public:
  explicit RandomSlab(std::uint64_t seed, const SlabRanges& ranges = {})
      : random_(seed), ranges_(ranges) {}

  Scene scene() {
    SceneSpec spec;
    spec.domain = "slab";
    spec.depth = std::exp(uniform(std::log(100.0), std::log(2000.0)));
    const double optical_depth =
        std::exp(uniform(std::log(ranges_.thinnest), std::log(ranges_.thickest)));
    constexpr double thickest_of_disks = 30;  // more would not fit
    if (uniform(0, 1) < 0.7 || optical_depth > thickest_of_disks) {
      spec.scatterer = "hg";
      spec.g = uniform(ranges_.least_g, ranges_.largest_g);
      spec.albedo = uniform(0, 1) < 0.3 ? 1 : uniform(0.5, 1);
      spec.mean_free_path = *spec.depth / optical_depth;
    } else {
      spec.scatterer = uniform(0, 1) < 0.5 ? "soft" : "te";
      spec.radius = uniform(0.05, 0.8);
      if (spec.scatterer == "te") spec.index = uniform(0, 1) < 0.5 ? "1.3" : "1.4+0.02i";
      spec.density = 1e-4;
      spec.density = 1e-4 * optical_depth / (make_scene(spec).medium.mu_t * *spec.depth);
    }
    Scene scene = make_scene(spec);
    scene.request = pairs_request(pairs(*spec.depth));
    return scene;
  }

 private:
  double uniform(double from, double to) {
    return std::uniform_real_distribution(from, to)(random_);
  }

  /// Returns pairs of angles whose tilted directions stay above the horizon.
  std::vector<AnglePair> pairs(double depth) {
    std::vector<AnglePair> list;
    const double light = uniform(-1.2, 1.2);
    for (const double view :
         {uniform(-1.2, 1.2), pi + uniform(-1.2, 1.2), pi + light + uniform(-1, 1) / depth}) {
      list.push_back({light, view, light, view});
      for (const double q : {uniform(-4, 4) / depth, uniform(-0.3, 0.3)}) {
        const bool above = std::abs(std::sin(light) + q / wavenumber) < 0.99 &&
                           std::abs(std::sin(view) + q / wavenumber) < 0.99;
        if (above) list.push_back({light, view, deflected(light, q), deflected(view, q)});
      }
    }
    return list;
  }

  std::mt19937_64 random_;
  SlabRanges ranges_;
};

}  // namespace flatspeckle::mc::tests

#pragma once

#include <cmath>
#include <vector>

#include "core/numbers/random.h"
#include "grin/fields/gaussian_blobs.h"
#include "grin/fields/radial_field.h"
#include "grin/fields/spline_field.h"
#include "grin/media/start_directions.h"
#include "grin/rays/ray.h"

namespace flatspeckle::grin::tests {

/// n^2 = 2 - r^2 out to r = sqrt 2, where n = 0: Luneburg's ball without its rim. Every ray is the
/// ellipse x0 cos sigma + v0 sin sigma (conventions, C27).
struct HarmonicProfile {
  double excess(double u) const { return (1 - u) / (1 + std::sqrt(2 - u)); }
  RadialJet jet(double u) const {
    const double n = std::sqrt(2 - u);
    return {excess(u), -1 / (2 * n), -1 / (4 * n * n * n)};
  }
};
using HarmonicBall = RadialField<HarmonicProfile, 3>;

/// About the origin, by its signed distance.
struct Ball {
  double radius;
  double distance(const Vec3& x) const { return x.norm() - radius; }
};

inline Vec3 random_direction(RandomStream& random) {
  return direction_about(Vec3::UnitX(), 2 * random.uniform() - 1,
                         6.283185307179586 * random.uniform());
}

/// Uniform in a ball about the origin.
inline Vec3 random_point(RandomStream& random, double radius) {
  return radius * std::cbrt(random.uniform()) * random_direction(random);
}

/// A dozen blobs about the unit ball, their heights up to +-height.
inline GaussianBlobs random_blobs(RandomStream& random, double height) {
  std::vector<GaussianBlob> blobs;
  for (int i = 0; i < 12; ++i)
    blobs.push_back({random_point(random, 1.2), height * (2 * random.uniform() - 1),
                     0.3 + 0.3 * random.uniform()});
  return GaussianBlobs(blobs);
}

/// The spline through independent samples in +-height on [-1.5, 1.5]^3, 9 nodes along each axis.
inline SplineField random_spline(RandomStream& random, double height) {
  const FieldGrid grid{Vec3::Constant(-1.5), Vec3::Constant(3.0 / 8), {9, 9, 9}};
  std::vector<double> excess(grid.size());
  for (double& sample : excess) sample = height * (2 * random.uniform() - 1);
  return SplineField(grid, excess);
}

}  // namespace flatspeckle::grin::tests

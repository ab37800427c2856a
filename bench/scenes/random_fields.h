#pragma once

#include "core/numbers/random.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/spline_field.h"

namespace flatspeckle::bench {

/// About the origin, by its signed distance.
struct Ball {
  double radius;
  double distance(const grin::Vec3& x) const { return x.norm() - radius; }
};

grin::Vec3 random_direction(RandomStream& random);
/// Uniform in a ball about the origin.
grin::Vec3 random_point(RandomStream& random, double radius);

/// A dozen blobs about the unit ball, their heights up to +-height.
grin::GaussianBlobs random_blobs(RandomStream& random, double height);
/// The spline through independent samples in +-height on [-1.5, 1.5]^3, 9 nodes along each axis.
grin::SplineField random_spline(RandomStream& random, double height);

}  // namespace flatspeckle::bench

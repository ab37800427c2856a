#pragma once

#include "core/numbers/random.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/spline_field.h"

namespace flatspeckle::bench {

/// A ball about the origin, given by its signed distance.
struct Ball {
  double radius;
  double distance(const grin::Vec3& x) const { return x.norm() - radius; }
};

grin::Vec3 random_direction(RandomStream& random);
/// Samples a point uniformly in a ball about the origin.
grin::Vec3 random_point(RandomStream& random, double radius);

/// Returns twelve random blobs around the unit ball, with heights between -height and height.
grin::GaussianBlobs random_blobs(RandomStream& random, double height);
/// Returns the spline through independent random values between -height and height, on 9 nodes
/// along each axis of [-1.5, 1.5]^3.
grin::SplineField random_spline(RandomStream& random, double height);

}  // namespace flatspeckle::bench

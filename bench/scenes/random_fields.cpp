#include "bench/scenes/random_fields.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::bench {

using namespace grin;

Vec3 random_direction(RandomStream& random) {
  const double azimuth = 2 * std::numbers::pi * random.uniform();
  return direction_about(Vec3::UnitX(), 2 * random.uniform() - 1, azimuth);
}

Vec3 random_point(RandomStream& random, double radius) {
  const Vec3 direction = random_direction(random);
  return radius * std::cbrt(random.uniform()) * direction;
}

GaussianBlobs random_blobs(RandomStream& random, double height) {
  std::vector<GaussianBlob> blobs;
  for (int i = 0; i < 12; ++i)
    blobs.push_back({random_point(random, 1.2), height * (2 * random.uniform() - 1),
                     0.3 + 0.3 * random.uniform()});
  return GaussianBlobs(blobs);
}

SplineField random_spline(RandomStream& random, double height) {
  const FieldGrid grid{Vec3::Constant(-1.5), Vec3::Constant(3.0 / 8), {9, 9, 9}};
  std::vector<double> excess(grid.size());
  for (double& sample : excess) sample = height * (2 * random.uniform() - 1);
  return SplineField(grid, excess);
}

}  // namespace flatspeckle::bench

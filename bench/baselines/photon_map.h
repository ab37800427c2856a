#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/run/runner.h"
#include "grin/render/methods/render_scene.h"

namespace flatspeckle::bench {

using grin::Vec3;

/// Where a sensor's ray collides; it takes the light that passes near.
struct GatherPoint {
  Vec3 x;
  Vec3 onwards;  ///< unit, the way of light from here to the sensor
  double value;  ///< times phase function and power of a photon: its contribution
  double optical_path;
  int pixel;
  grin::Part part;
};

/// Points in cells of a grid that is hashed (Teschner et al. 2003): those within a radius of a
/// place are in eight cells at the most.
class GatherGrid {
 public:
  GatherGrid(std::vector<GatherPoint> points, double radius);

  /// use(point) for all points within the radius of x.
  template <class Use>
  void near(const Vec3& x, const Use& use) const {
    std::array<std::uint32_t, 8> buckets;
    for (const std::uint32_t bucket : buckets_around(x, buckets))
      for (std::uint32_t i = first_[bucket]; i < first_[bucket + 1]; ++i)
        if ((points_[i].x - x).squaredNorm() < radius_ * radius_) use(points_[i]);
  }

 private:
  std::uint32_t bucket(double i, double j, double k) const;
  std::span<const std::uint32_t> buckets_around(const Vec3& x,
                                                std::array<std::uint32_t, 8>& buckets) const;

  std::vector<GatherPoint> points_;   ///< by bucket
  std::vector<std::uint32_t> first_;  ///< of each bucket, and the end
  double radius_;
};

/// The volume photon map (Jensen and Christensen 1998), the baseline: photons are left wherever
/// light collides, and the light that a sensor's ray finds where it collides at z is estimated from
/// those within a radius,
///   L/n^2 = albedo sum_j p(w_j, w) power_j / (mu_t n^2 4/3 pi radius^3)    at z, in the same part.
/// This blurs: the expectation is off by O(radius^2), and by O(radius) at walls. All scattering but
/// the last is in the photons, so sensor rays end at their first collision. Light that comes
/// unscattered is not blurred: points and beams hit the sensor, rays of the sensor hit other
/// lights. A pinhole misses what comes unscattered from a point or in a beam.
///
/// All rays of the sensor come first and each photon is given to those it is near to as it arises:
/// the same sum over pairs as when photons are kept, in memory that does not grow with depth.
///
/// Pairs grow with the square of the paths: many make a map. Sums of a batch: [pixel][TimeBins].
BatchJob photon_map_job(const grin::RenderScene& scene, double radius, std::uint64_t seed,
                        int paths = 16384);

}  // namespace flatspeckle::bench

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/run/runner.h"
#include "grin/render/methods/render_scene.h"

namespace flatspeckle::bench {

using grin::Vec3;

/// First collision of a sensor ray. It gathers the photons deposited nearby.
struct GatherPoint {
  Vec3 x;
  Vec3 to_sensor;  ///< unit vector, direction of light from here to the sensor
  double value;    ///< contribution of a photon divided by its power and the phase function
  double optical_path;
  int pixel;
  grin::Part part;
};

/// Points in the cells of a hashed grid (Teschner et al. 2003). All points within one radius of a
/// position are in at most eight cells.
class GatherGrid {
 public:
  GatherGrid(std::vector<GatherPoint> points, double radius);

  /// Calls use(point) for all points within the radius of x.
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

  std::vector<GatherPoint> points_;   ///< sorted by bucket
  std::vector<std::uint32_t> first_;  ///< index of the first point of each bucket; the last element
                                      ///< is the number of points
  double radius_;
};

/// Estimates a picture by the volume photon map [jensen1998], a baseline. Photons are deposited at
/// every collision of a light path. The radiance at z, the first collision of a sensor ray, is
/// estimated from the photons within a radius,
///   L/n^2 = albedo sum_j p(w_j, w) power_j / (mu_t n^2 4/3 pi radius^3)    at z, in the same part.
/// This is biased: the expectation is off by O(radius^2), and by O(radius) at walls. The photons
/// contain all scattering but the last, so sensor rays end at their first collision. Unscattered
/// light is not blurred: light from point sources and beams is scored where it hits the sensor,
/// light of other sources where sensor rays hit the source. Unscattered light from a point source
/// or beam therefore does not reach a pinhole camera.
///
/// All sensor rays are traced first, and each photon is scored to the nearby ones when it is
/// deposited. The sum over pairs equals that of a stored map, in memory that does not grow with
/// depth.
///
/// The number of pairs of photons and sensor rays grows with the square of the paths per map. Sums
/// of a batch: [pixel][TimeBins].
BatchJob photon_map_job(const grin::RenderScene& scene, double radius, std::uint64_t seed,
                        int paths = 16384);

}  // namespace flatspeckle::bench

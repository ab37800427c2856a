#pragma once

#include <optional>
#include <vector>

#include "grin/media/scattering/free_flight.h"
#include "grin/render/flights/space.h"
#include "grin/render/methods/moving_field.h"
#include "grin/render/methods/path_kernels.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// Approximate importance of light for sensors that are small disks on the boundary, for splitting
/// and Russian roulette, which are unbiased for any importance. Most scattered light misses such
/// sensors; the rare light that heads for them dominates the variance.
class SensorTarget {
 public:
  /// Returns nullopt if a sensor is not a small disk. bending: largest angle, in rad, between light
  /// guided by the index field and the axis of the guide.
  static std::optional<SensorTarget> of(const Transport& transport, const Space& space,
                                        double bending);

  /// Samples the first flight from a stratum `place` in (0, 1).
  ImportanceSampledFlight first_flight(const Vec3& x, const Vec3& direction, double place) const;

  /// Importance of light at x: before_turn() for light that has arrived along a direction and will
  /// be scattered, towards() for light that leaves along a direction. Both are normalised so that
  /// emitted light has an average importance of `parts`, the initial number of branches of a path.
  double before_turn(const Vec3& x, const Vec3& arrived) const {
    return importance(x, arrived, turn_) / mean_importance_;
  }
  double towards(const Vec3& x, const Vec3& direction) const {
    return importance(x, direction, 0) / mean_importance_;
  }

 private:
  struct Disk {
    Vec3 centre, outwards;
    double radius;
  };
  static std::optional<Disk> disk_of(const SensorEnd& sensor, const Space& space, double largest);
  SensorTarget(std::vector<Disk> disks, const ScatteringMedium& medium, double bending);
  double mean_importance(const Transport& transport, const Space& space) const;

  double importance(const Vec3& x, const Vec3& direction, double turn) const;
  double importance(const Disk& disk, const Vec3& x, const Vec3& direction, double turn) const;

  std::vector<Disk> disks_;
  double mu_t_, attenuation_, longest_, bending_, turn_, mean_importance_ = 1;
};

/// Returns the control variates of counted paths, of straight rays that are not split; else null.
const ControlVariates* forward_controls(const Transport& transport, bool has_target);

/// Forward (photon) tracing: light paths that are tallied where they hit sensors, without
/// connections. Each is cheap, and no contribution greatly exceeds the power of its path. With a
/// target, paths that head for the sensors are split, and most other paths are terminated. Flights
/// are traced in SIMD lanes if the space supports them; each path has its own random stream.
/// Unscattered light of beams is left out (unscattered_beams.h), except with sound that tags it.
/// moving: the field of the space if
/// derivatives by its parameters are requested, else null.
PathKernel forward_kernel(std::shared_ptr<const Transport> transport,
                          std::shared_ptr<const Space> space, std::optional<SensorTarget> target,
                          bool random_phase, std::shared_ptr<const MovingField> moving = nullptr);

}  // namespace flatspeckle::grin

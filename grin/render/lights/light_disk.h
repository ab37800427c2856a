#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

enum class Spread { even, gaussian };

/// A rotationally symmetric probability density over the plane: uniform for distances r up to
/// `radius`, or proportional to exp(-2 r^2 / radius^2) and truncated at r = 3 radius, which leaves
/// out a fraction of 1.5e-8. Both are also truncated at r = limit. Arguments `square` are values of
/// r^2.
class RadialProfile {
 public:
  RadialProfile(Spread spread, double radius,
                double limit = std::numeric_limits<double>::infinity())
      : radius_(radius),
        rim_(std::fmin(spread == Spread::even ? radius : 3 * radius, limit)),
        decay_(spread == Spread::even ? 0 : 2 / (radius * radius)),
        share_(-std::expm1(-decay_ * rim_ * rim_)) {}

  bool is_even() const { return decay_ == 0; }
  double radius() const { return radius_; }
  double rim() const { return rim_; }
  bool contains(double square) const { return square <= rim_ * rim_; }
  /// Returns the quantile u of r^2; u in (0, 1).
  double square(double u) const {
    return is_even() ? u * rim_ * rim_ : -std::log1p(-u * share_) / decay_;
  }
  /// Returns the density per area at r^2 = square within the rim.
  double density(double square) const {
    if (is_even()) return 1 / (std::numbers::pi * rim_ * rim_);
    return decay_ * std::exp(-decay_ * square) / (std::numbers::pi * share_);
  }

 private:
  double radius_, rim_, decay_, share_;
};

/// A disk inside the stage, or on its boundary, that emits light to one side.
class LightDisk {
 public:
  /// Throws InputError, naming `light` and "radius" or "direction", if the disk extends beyond the
  /// stage or emits out of it.
  LightDisk(const char* light, const Vec3& centre, const Vec3& direction,
            const RadialProfile& profile, const Stage& stage);

  const Vec3& centre() const { return disk_.centre(); }
  const Vec3& axis() const { return disk_.normal(); }
  bool contains(const Vec3& x) const { return disk_.reaches(x); }
  /// Probability density of a point of the disk, per area.
  double density(const Vec3& x) const { return profile_.density((x - centre()).squaredNorm()); }
  BoundaryPoint sample(RandomStream& random) const;
  /// Maps the unit square to the disk such that uniform points (u, v) are distributed by the
  /// profile.
  BoundaryPoint from_square(double u, double v) const;

 private:
  FlatDisk disk_;
  RadialProfile profile_;
};

}  // namespace flatspeckle::grin

#pragma once

#include <array>
#include <optional>
#include <vector>

#include "grin/media/scattering/diffusion_rate.h"
#include "grin/render/lights/light.h"
#include "grin/render/sensors/sensor.h"
#include "grin/render/stage/straight_stage.h"

namespace flatspeckle::grin {

/// What light at a place is worth to the sensors, where little of it comes to them: it grows along
/// the straight way to a sensor as diffuse light dies out, exp(kappa s), from where only a small
/// share of the light is left; nearer to the lights it is 1. Light is split where the worth rises
/// and plays roulette where it falls. It changes the variance alone.
class DepthImportance {
 public:
  /// Nothing where no sensor is deep behind a medium, and where ways lead through several bodies
  /// or one of any shape.
  static std::optional<DepthImportance> of(const Stage& stage, const StageLights& lights,
                                           const std::vector<Sensor>& sensors);

  struct Outlook {
    double worth;
    Vec3 rise;  ///< gradient of log(worth)
  };
  Outlook outlook(const PathPoint& p) const;

  /// With which joins from here to any sensor are considered: seldom where little light could get
  /// out of the medium unscattered, more or less exp(1 - depth / 2).
  double chance_to_join(const PathPoint& p) const;
  /// And of these joins those to one of them: few where paths hit it much more easily.
  double share_of_joins(std::size_t sensor) const { return destinations_[sensor].joined; }
  double most_joins() const { return most_joins_; }  ///< the largest of these shares

  /// The slow mode along the way from where light begins to a sensor. What a path gains of it,
  /// steps, turns and roulette, is 0 on average, wherever it ends, and most light that is through
  /// has gained about the same: a control variate, of the greatest worth in deep slabs.
  struct Drift {
    SlowMode mode;
    Vec3 axis, from;
    double mu_t, albedo;

    double cosine(const Vec3& direction) const { return axis.dot(direction); }
    double growth(const Vec3& x) const { return mode.growth(mu_t * axis.dot(x - from)); }
  };
  /// Nothing where media differ, or scatter in another way than the mode knows.
  const std::optional<Drift>& drift() const { return drift_; }

  /// Whether light is split; else the media are deep alone.
  bool favours_deep() const { return favours_deep_; }

 private:
  using ByPart = std::array<double, 2>;  ///< of two at the most
  struct Destination {
    NearestPlace nearest;
    ByPart decay = {};  ///< of diffuse light
    double log_share =
        0;  ///< of diffuse light that gets there, from where the worth begins to rise
    bool is_deep = false;
    double joined = 1;
  };
  struct Way {
    Vec3 direction;
    ByPart length = {};

    double along(const ByPart& rate) const { return rate[0] * length[0] + rate[1] * length[1]; }
  };

  DepthImportance(const Stage& stage, const StageLights& lights,
                  const std::vector<Sensor>& sensors);

  Way way(const PathPoint& p, const Destination& to) const;
  ByPart decay(const Stage& stage, const Vec3& direction) const;
  void find_shares(Destination& to, const std::vector<PathPoint>& starts);

  void find_drift(const Stage& stage, const PathPoint& start);
  double clearance(const PathPoint& p) const;

  Surface boundary_;
  std::optional<Surface> body_;
  ByPart extinction_ = {};
  std::vector<Vec3> inner_;  ///< sensors that are not on the boundary
  std::vector<Destination> destinations_;
  std::optional<Drift> drift_;
  bool favours_deep_ = false, is_thick_ = false;
  double most_joins_ = 0;
};

}  // namespace flatspeckle::grin

#pragma once

#include <array>
#include <optional>
#include <vector>

#include "grin/render/lights/light.h"
#include "grin/render/sensors/sensor.h"
#include "grin/render/transport/control_variates.h"

namespace flatspeckle::grin {

/// Importance of a position for sensors that little light reaches. Near the lights it is 1. Beyond
/// the depth at which only a small share of the light is left, it grows with the distance s along
/// the straight line to a sensor as exp(kappa s), where kappa is the decay rate of diffuse light.
/// Paths are split where the importance grows and undergo Russian roulette where it falls. Only the
/// variance depends on it, not the mean.
class DepthImportance {
 public:
  /// Returns nullopt if no medium is thick, or if the stage has several bodies or a shape other than
  /// a box or a sphere.
  static std::optional<DepthImportance> of(const Stage& stage, const StageLights& lights,
                                           const std::vector<Sensor>& sensors);

  struct ImportanceAndGradient {
    double importance;
    Vec3 log_gradient;  ///< gradient of log(importance)
  };
  ImportanceAndGradient importance_and_gradient(const PathPoint& p) const;

  /// Probability with which connections from p to any sensor are considered. It is low where little
  /// light could leave the medium unscattered: roughly exp(1 - depth / 2), where depth is the
  /// smallest optical depth from p to the surface of its part or to a pinhole.
  double connection_probability(const PathPoint& p) const;
  /// Fraction of the considered connections that are made to this sensor: small if paths that hit
  /// the sensor are much more effective than connections to it.
  double fraction_of_connections(std::size_t sensor) const {
    return destinations_[sensor].connected;
  }
  /// Largest fraction_of_connections() of all sensors.
  double most_connections() const { return most_connections_; }

  /// Control variates of light paths along the line from a light to the most distant sensor.
  const std::optional<ControlVariates>& control_variates() const { return control_variates_; }

  /// Whether light paths are split; if not, only the number of connections is reduced.
  bool favours_deep() const { return favours_deep_; }

 private:
  /// Values in the surroundings and in the body, if any.
  using ByPart = std::array<double, 2>;
  struct Destination {
    NearestPlace nearest;
    ByPart decay = {};  ///< decay rate of diffuse light
    /// Logarithm of the importance at the sensor: integral of `decay` along the straight line to
    /// the sensor, from the depth at which the importance begins to grow.
    double log_share = 0;
    bool is_deep = false;
    double connected = 1;  ///< fraction_of_connections() of this sensor
  };
  struct StraightPath {
    Vec3 direction;
    ByPart length = {};

    double along(const ByPart& rate) const { return rate[0] * length[0] + rate[1] * length[1]; }
  };

  DepthImportance(const Stage& stage, const StageLights& lights,
                  const std::vector<Sensor>& sensors);

  StraightPath path_to(const PathPoint& p, const Destination& to) const;
  ByPart decay(const Stage& stage, const Vec3& direction) const;
  void find_shares(Destination& to, const std::vector<PathPoint>& starts);

  Vec3 direction_to_farthest(const PathPoint& start) const;
  bool pays(const ControlVariates& variates) const;
  double clearance(const PathPoint& p) const;

  Surface boundary_;
  std::optional<Surface> body_;
  ByPart extinction_ = {};
  std::vector<Vec3> inner_;  ///< positions of pinhole cameras
  std::vector<Destination> destinations_;
  std::optional<ControlVariates> control_variates_;
  bool favours_deep_ = false;
  bool is_thick_ = false;  ///< whether all light that reaches some sensor passes a thick medium
  double most_connections_ = 0;
};

}  // namespace flatspeckle::grin

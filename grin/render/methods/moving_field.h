#pragma once

#include <memory>
#include <span>
#include <vector>

#include "grin/media/fields/any_index_field.h"
#include "grin/media/scattering/scattering_medium.h"
#include "grin/render/flights/space.h"
#include "grin/render/sensors/sensor_edges.h"

namespace flatspeckle::grin {

/// The index field of a stage, and derivatives of rays by parameters of the field.
class MovingField {
 public:
  struct Scene {
    const AnyIndexField& field;
    const Stage& stage;  ///< must be a box with one uniform medium
    SpaceOptions options;
    std::span<const FieldParameter> parameters;
    std::vector<SensorEdges> edges;
  };
  explicit MovingField(const Scene& scene);

  std::size_t parameters() const { return sides_.size(); }
  double scale(std::size_t parameter) const { return sides_[parameter].scale; }
  const std::vector<SensorEdges>& edges() const { return edges_; }
  const ScatteringMedium& medium() const { return medium_; }
  IndexGradient index(const Vec3& x) const { return field_->gradient(x); }
  /// Returns the derivative of ln n at x by a parameter.
  double index_change(std::size_t parameter, const Vec3& x) const;

  struct Ray {
    Vec3 x = Vec3::Zero(), direction = Vec3::Zero();
  };
  /// Traces rays to the boundary without collisions.
  std::vector<Flight> flown(std::span<const Ray> starts) const;

  /// Derivatives of a ray's position and direction by a parameter.
  struct Motion {
    Vec3 x = Vec3::Zero(), direction = Vec3::Zero();
  };
  /// Arc lengths, by ray.
  using Lengths = std::vector<double>;
  /// Returns the motions [stop][ray] of rays at the arc lengths stops[stop][ray], which increase
  /// with `stop`. motions: motions of the starts.
  std::vector<std::vector<Motion>> moved(std::size_t parameter, std::span<const Ray> starts,
                                         std::span<const Motion> motions,
                                         std::span<const Lengths> stops) const;

  /// Returns the gradient of a ray's arc length to the boundary with respect to a displacement of
  /// the ray. x, direction: position and direction of the ray at the boundary.
  Vec3 exit_distance(const Vec3& x, const Vec3& direction) const {
    const Vec3 outwards = stage_.normal(x);
    return -outwards / outwards.dot(direction);
  }

 private:
  /// The fields with a parameter decreased and increased by `step`.
  struct Sides {
    std::unique_ptr<const RayField> less, more;
    double scale, step;
  };

  std::unique_ptr<const RayField> field_;
  std::unique_ptr<const Space> clear_;  ///< without scattering: flights end on the boundary
  std::vector<Sides> sides_;
  Box stage_;
  ScatteringMedium medium_;
  double step_;
  std::vector<SensorEdges> edges_;
};

}  // namespace flatspeckle::grin

#pragma once

#include <memory>
#include <span>
#include <vector>

#include "grin/media/fields/any_index_field.h"
#include "grin/media/scattering/scattering_medium.h"
#include "grin/render/flights/space.h"
#include "grin/render/sensors/sensor_edges.h"

namespace flatspeckle::grin {

/// The field of a stage, as light paths need it that move with its parameters.
class MovingField {
 public:
  struct Scene {
    const AnyIndexField& field;
    const Stage& stage;  ///< a box, of one uniform medium
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
  /// d(ln n) for each unit of a parameter.
  double index_change(std::size_t parameter, const Vec3& x) const;

  struct Ray {
    Vec3 x = Vec3::Zero(), direction = Vec3::Zero();
  };
  /// To the boundary, without collisions.
  std::vector<Flight> flown(std::span<const Ray> starts) const;

  /// For each unit of a parameter.
  struct Motion {
    Vec3 x = Vec3::Zero(), direction = Vec3::Zero();
  };
  /// [stop][ray]: of rays after arc lengths [stop][ray], which increase; their starts move too.
  using Lengths = std::vector<double>;
  std::vector<std::vector<Motion>> moved(std::size_t parameter, std::span<const Ray> starts,
                                         std::span<const Motion> motions,
                                         std::span<const Lengths> stops) const;

  /// d(arc length to the boundary) = way . d(x), of light that leaves at x; to there x moves on.
  Vec3 way_out(const Vec3& x, const Vec3& direction) const {
    const Vec3 outwards = stage_.normal(x);
    return -outwards / outwards.dot(direction);
  }

 private:
  /// A parameter's two fields.
  struct Sides {
    std::unique_ptr<const RayField> less, more;
    double scale, step;
  };

  std::unique_ptr<const RayField> field_;
  std::unique_ptr<const Space> clear_;  ///< where flights go to the boundary
  std::vector<Sides> sides_;
  Box stage_;
  ScatteringMedium medium_;
  double step_;
  std::vector<SensorEdges> edges_;
};

}  // namespace flatspeckle::grin

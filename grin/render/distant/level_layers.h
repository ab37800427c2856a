#pragma once

#include <optional>
#include <vector>

#include "grin/rays/surfaces/signed_distance.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// A layer of a stage between two planes. Coordinates of LevelLayers: the third one is along the
/// normal of the layers.
struct LevelLayer {
  Part part;
  double low, high;
  double excess;  ///< index - 1
  ScatteringMedium medium;

  bool scatters() const { return medium.mu_s > 0; }
};

/// A stage that consists of uniform layers normal to one axis of its box. The first and the last
/// layer belong to the surroundings of the bodies; they have no thickness where a body touches the
/// boundary.
class LevelLayers {
 public:
  /// Returns nullopt if the stage has another shape, if no layer scatters, or if there is a layer
  /// without scattering between layers that scatter. axis: number of the axis, 0 to 2.
  /// field_excess: index - 1 of the part that the field fills.
  static std::optional<LevelLayers> of(const Stage& stage, int axis, double field_excess);

  /// Converts a vector from coordinates of the stage, and back.
  Vec3 local(const Vec3& v) const { return {v[(axis_ + 1) % 3], v[(axis_ + 2) % 3], v[axis_]}; }
  Vec3 global(const Vec3& v) const {
    Vec3 of_stage;
    of_stage[(axis_ + 1) % 3] = v[0];
    of_stage[(axis_ + 2) % 3] = v[1];
    of_stage[axis_] = v[2];
    return of_stage;
  }

  int axis() const { return axis_; }
  const Vec3& low() const { return low_; }    ///< lower corner of the stage
  const Vec3& high() const { return high_; }  ///< upper corner of the stage
  const std::vector<LevelLayer>& layers() const { return layers_; }
  /// Numbers of the first and of the last layer that scatter.
  int first() const { return first_; }
  int last() const { return last_; }
  /// Whether light in this layer leaves the stage once it heads outwards.
  bool is_outermost(int layer) const { return layer < first_ || layer > last_; }
  /// Distance from a point to the nearest side of the stage, which is parallel to the axis.
  double distance_to_sides(const Vec3& x) const;

 private:
  LevelLayers(int axis, const Box& box);
  void add(const Stage& stage, Part part, double low, double high, double field_excess);

  int axis_;
  Vec3 low_, high_;
  std::vector<LevelLayer> layers_;
  int first_ = 0, last_ = 0;
};

}  // namespace flatspeckle::grin

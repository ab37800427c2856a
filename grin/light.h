#pragma once

#include <functional>
#include <span>
#include <variant>
#include <vector>

#include "grin/path_end.h"
#include "grin/stage.h"

namespace flatspeckle::grin {

/// Isotropic, at x inside the stage.
struct PointLight {
  Vec3 x;
  double power = 1;
};

/// Parallel rays, uniform over a disk inside the stage or on its boundary.
struct BeamLight {
  Vec3 centre, direction;
  double radius;
  double power = 1;
};

/// The part of the boundary within `radius` of `centre`, Lambertian inwards: L/n^2 = radiance. An
/// infinite radius is the environment. Sphere and box boundaries only.
struct FaceLight {
  Vec3 centre = Vec3::Zero();
  double radius;
  double radiance = 1;
};

using Light = std::variant<PointLight, BeamLight, FaceLight>;

/// All lights of a scene; one of them is drawn for each path, by its power.
class Lights {
 public:
  using Index = std::function<double(const PathPoint&)>;

  /// Throws InputError naming the light's key for no lights, a light outside the stage, a power
  /// that is not positive.
  Lights(std::vector<Light> lights, const Stage& stage, Index index);

  EndPosition sample_position(RandomStream& random) const;
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const;
  /// Towards a given direction, for joins.
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;
  /// A path arrives on the boundary at x along `direction`: calls use(EndHit) for each light there.
  template <class Use>
  void hit(const Vec3& x, const Vec3& direction, const Use& use) const;

  double power() const { return power_; }

 private:
  std::vector<Light> lights_;
  double power_ = 0;
};

}  // namespace flatspeckle::grin

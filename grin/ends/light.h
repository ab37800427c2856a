#pragma once

#include <functional>
#include <variant>
#include <vector>

#include "core/numbers/random.h"
#include "grin/ends/boundary_patch.h"
#include "grin/ends/path_end.h"

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
/// infinite radius is the environment. Sphere and box boundaries only, see BoundaryPatch. Its power
/// is radiance pi times the integral of n^2 over the part.
struct FaceLight {
  Vec3 centre = Vec3::Zero();
  double radius;
  double radiance = 1;
};

using Light = std::variant<PointLight, BeamLight, FaceLight>;

/// All lights of a scene; one of them is drawn for each path, by its power. `space` in the calls is
/// asked for space.index(PathPoint) alone.
class Lights {
 public:
  using Index = std::function<double(const PathPoint&)>;

  /// The index is that of the powers. Throws InputError naming the light for no lights, a light
  /// that is not inside the stage, a beam that leaves it at once, and sizes or powers that are not
  /// positive and finite.
  Lights(std::vector<Light> lights, const Stage& stage, const Index& index);

  template <class S>
  EndPosition sample_position(const S& space, RandomStream& random) const {
    EndPosition at = draw_position(random);
    at.index = space.index(at.point);
    return at;
  }
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const;
  /// As SensorEnd's; lights have no other choice than that of sample_position.
  double choice(const EndPosition&, const Vec3&) const { return 1; }
  /// Towards a given direction, for joins.
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;

  /// Power of all beams.
  double beam_power() const { return beam_power_; }
  /// A place on one of the beams: which, by their power, says `stratum` in (0, 1); where, (u, v) in
  /// the unit square. Its direction is `inward`.
  EndPosition beam_position(double stratum, double u, double v) const;

  /// A path arrives on the boundary at x along `direction`: calls use(EndHit) for each light there.
  template <class S, class Use>
  void hit(const S& space, const Vec3& x, const Vec3& direction, const Use& use) const {
    for (const int light : faces_) {
      if (!source_[light].patch->contains(x)) continue;
      EndPosition at = position(light, {x, source_[light].patch->inward(x)});
      at.index = space.index(at.point);
      use_hit(at, towards(at, -direction), use);
    }
  }

  double power() const { return power_; }

 private:
  struct Source {
    Light light;  ///< directions of beams are unit vectors
    double power = 0;
    double chance = 0;         ///< to be drawn
    double chance_so_far = 0;  ///< this and all before
    double position_density = 1;
    std::optional<BoundaryPatch> patch = {};  ///< of a face
    std::optional<FlatDisk> disk = {};        ///< of a beam
  };
  EndPosition draw_position(RandomStream& random) const;
  EndPosition position(int light, const BoundaryPoint& at) const;
  EndPosition on_beam(int beam, const Vec3& x) const;
  static Source source(const PointLight& light, const Stage& stage, const Index& index);
  static Source source(const BeamLight& light, const Stage& stage, const Index& index);
  static Source source(const FaceLight& light, const Stage& stage, const Index& index);

  std::vector<Source> source_;
  std::vector<int> faces_, beams_;
  std::optional<Surface> body_;
  double power_ = 0, beam_power_ = 0;
};

}  // namespace flatspeckle::grin

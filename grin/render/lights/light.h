#pragma once

#include <variant>
#include <vector>

#include "core/numbers/random.h"
#include "grin/render/lights/beam_light.h"
#include "grin/render/lights/face_light.h"
#include "grin/render/lights/fibre_light.h"
#include "grin/render/lights/point_light.h"

namespace flatspeckle::grin {

template <class... Kind>
struct LightKinds : Kind... {
  using Light = std::variant<typename Kind::Light...>;
  using End = std::variant<typename Kind::Light::End...>;
};

/// The lights of a stage as keys have them, of all kinds (light_kind.h); the one list of them.
using LightValues =
    LightKinds<PointLightValues, BeamLightValues, FibreLightValues, FaceLightValues>;
using Light = LightValues::Light;

void add_keys(Keys& keys, LightValues& values);
/// Kind after kind. Throws InputError.
std::vector<Light> make_lights(const Keys& keys, const LightValues& values);

/// All lights of a scene; one of them is drawn for each path, by its power. `space` in the calls is
/// asked for space.index(PathPoint) alone.
class StageLights {
 public:
  /// The index is that of the powers. Throws InputError naming the light for no lights, a light
  /// that is not inside the stage, a beam that leaves it at once, and sizes or powers of which
  /// nothing can be drawn.
  StageLights(const std::vector<Light>& lights, const Stage& stage, const IndexAt& index);

  template <class S>
  EndPosition sample_position(const S& space, RandomStream& random) const {
    EndPosition at = draw_position(random);
    at.index = space.index(at.point);
    return at;
  }
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const;
  /// Towards a given direction, for joins.
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;

  /// Of light that sample_direction gave.
  EmissionChange by_index(const EndPosition& at, const Vec3& direction) const;

  /// Power of all beams.
  double beam_power() const { return beam_power_; }
  /// A place on one of the beams: which, by their power, says `stratum` in (0, 1); where, (u, v) in
  /// the unit square. Its direction is `inward`.
  EndPosition beam_position(double stratum, double u, double v) const;
  /// The same where u is the stratum's place among those of its beam.
  EndPosition beam_position(double stratum, double v) const;
  /// One of the beams, as a stratum says.
  struct Beam {
    std::size_t number;
    const LightDisk& disk;
    double power;  ///< of all beams
    /// At a place of the disk, if all power were in this beam.
    double irradiance(const Vec3& x) const { return power * disk.density(x); }
    ParallelLight light() const { return {disk.centre(), disk.axis()}; }
  };
  Beam beam(double stratum) const { return beam_at(beam_place(stratum).number); }
  Beam beam_at(std::size_t number) const;
  /// That of a place which is on a beam.
  Beam beam_of(const EndPosition& at) const;
  std::size_t beams() const { return beams_.size(); }
  /// And nothing else, so that no path from a sensor is joined to a light or hits one.
  bool are_beams() const { return beams_.size() == source_.size(); }

  /// A path arrives on the boundary at x along `direction`: calls use(EndHit) for each light there.
  template <class S, class Use>
  void hit(const S& space, const Vec3& x, const Vec3& direction, const Use& use) const {
    for (const int light : faces_) {
      const auto& face = std::get<FaceLightEnd>(source_[light].end);
      if (!face.contains(x)) continue;
      EndPosition at = position(light, {x, face.inward(x)});
      at.index = space.index(at.point);
      use_hit(at, face.towards(at, -direction), use);
    }
  }

  double power() const { return power_; }

 private:
  struct Source {
    LightValues::End end;
    double power;
    double chance = 0;         ///< to be drawn
    double chance_so_far = 0;  ///< this and all before
  };
  void settle_chances();
  struct PlaceInBeam {
    std::size_t number;
    double u;  ///< its place among the strata of this beam
  };
  PlaceInBeam beam_place(double stratum) const;
  EndPosition position_on(std::size_t beam, double u, double v) const;
  EndPosition draw_position(RandomStream& random) const;
  EndPosition position(int light, const BoundaryPoint& at) const;

  std::vector<Source> source_;
  std::vector<int> faces_, beams_;
  Regions regions_;
  double power_ = 0, beam_power_ = 0;
};

}  // namespace flatspeckle::grin

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

/// Values of the keys of all kinds of lights (light_kind.h). Kinds of lights are listed only here.
using LightValues =
    LightKinds<PointLightValues, BeamLightValues, FibreLightValues, FaceLightValues>;
using Light = LightValues::Light;

void add_keys(Keys& keys, LightValues& values);
/// Makes the lights, ordered by kind. Throws InputError.
std::vector<Light> make_lights(const Keys& keys, const LightValues& values);

/// All lights of a scene; each path samples one of them in proportion to its power. Arguments
/// `space` need only a function index(PathPoint), which returns the index of refraction.
class StageLights {
 public:
  /// index: index of refraction, for the powers of lights with a given L/n^2. Throws InputError if
  /// there are no lights, a light is not inside the stage, a beam points out of it, or a size or
  /// power cannot be sampled in double precision.
  StageLights(const std::vector<Light>& lights, const Stage& stage, const IndexAt& index);

  template <class S>
  EndPosition sample_position(const S& space, RandomStream& random) const {
    EndPosition at = draw_position(random);
    at.index = space.index(at.point);
    return at;
  }
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const;
  /// Returns strength and density of a given direction, for connections.
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;

  /// Returns the derivatives of light from sample_direction() by ln n, with n the index at its
  /// start.
  EmissionChange by_index(const EndPosition& at, const Vec3& direction) const;

  /// Total power of all beams.
  double beam_power() const { return beam_power_; }
  /// Returns a position on one of the beams: `stratum` in (0, 1) selects the beam by power, and
  /// (u, v) in the unit square the position on it. The direction of the beam is `inward`.
  EndPosition beam_position(double stratum, double u, double v) const;
  /// Returns a position on one of the beams; u is the position, from 0 to 1, of `stratum` within
  /// the interval of strata that selects this beam.
  EndPosition beam_position(double stratum, double v) const;
  /// One of the beams, with its number.
  struct Beam {
    std::size_t number;
    const LightDisk& disk;
    double power;  ///< total power of all beams, not of this one alone
    /// Irradiance at a position on the disk if this beam had the power of all beams.
    double irradiance(const Vec3& x) const { return power * disk.density(x); }
    ParallelLight light() const { return {disk.centre(), disk.axis()}; }
  };
  Beam beam(double stratum) const { return beam_at(beam_place(stratum).number); }
  Beam beam_at(std::size_t number) const;
  /// Returns the beam on which a position lies.
  Beam beam_of(const EndPosition& at) const;
  std::size_t beams() const { return beams_.size(); }
  /// Whether all lights are beams. Sensor paths then cannot hit a light, and connect only to beams.
  bool are_beams() const { return beams_.size() == source_.size(); }

  /// Calls use(EndHit) for each light hit by a path that arrives on the boundary at x along
  /// `direction`.
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

  /// Aims the face lights that do not surround the stage, which changes only how directions are
  /// sampled. Returns whether there are any.
  bool aim(const Aim& at);

 private:
  struct Source {
    LightValues::End end;
    double power;
    double probability = 0;         ///< probability of being sampled
    double probability_so_far = 0;  ///< sum of the probabilities up to and including this one
  };
  void settle_probabilities();
  struct PlaceInBeam {
    std::size_t number;
    /// Position, from 0 to 1, of the stratum within the interval of strata that selects this beam.
    double u;
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

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "grin/media/index/sound.h"
#include "grin/media/index/sound_waves.h"

namespace flatspeckle::grin {

/// Sound focused by an array, in the far-field approximation: N plane waves of equal strength,
/// equal wavenumber k and unit directions d_j, all in phase at the focus. At the phase psi of the
/// sound,
///   n = 1 + background + amplitude / N sum_j cos(k d_j.(x - focus) - psi).
/// Waves whose directions lie in one plane focus on a line, which passes through the focus
/// perpendicular to this plane. Waves whose directions fill a cone focus at a point.
class FocusedSound : public SoundWaves {
 public:
  /// Requires k > 0 and at least one direction. Directions are vectors of any length except 0.
  FocusedSound(double background, double amplitude, double k, const std::vector<Vec3>& directions,
               const Vec3& focus, double psi = 0);

  /// Returns the field of this sound at the phase psi.
  FocusedSound frozen(double psi) const;

  /// Returns the amplitude of the index modulation by one plane wave.
  double amplitude() const { return waves_.front().amplitude; }
  double wavenumber() const { return k_; }

 private:
  double k_, psi_;
};

/// Returns `count` directions in the x-z plane, whose angles to the z axis are evenly distributed
/// from -aperture to aperture. They give a line focus along y.
std::vector<Vec3> arc_directions(int count, double aperture);

/// Returns `count` directions spread evenly over the cap of half-angle `aperture` about the z axis.
/// They give a point focus.
std::vector<Vec3> cap_directions(int count, double aperture);

/// Returns the field of the sound at the given phase.
inline FocusedSound at_phase(const FocusedSound& field, double phase) {
  return field.frozen(phase);
}

inline FieldFacts facts(const FocusedSound& field) {
  return {.scale = 1 / field.wavenumber(), .strength = field.largest()};
}

struct FocusedSoundValues : SoundValues {
  using Field = FocusedSound;
  static constexpr const char* word = "focused_sound";
  std::int64_t emitters = 16;
  double aperture = 0.5;
  std::string focusing = "cone";
  std::vector<double> centre{0, 0, 0};
};

void add_keys(Keys& keys, FocusedSoundValues& values);
FocusedSound make_field(const Keys& keys, const FocusedSoundValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin

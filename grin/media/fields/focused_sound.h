#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "grin/media/index/sound.h"
#include "grin/media/index/sound_waves.h"

namespace flatspeckle::grin {

/// Sound focused by an array in its far field: plane waves of equal strength, all in phase at the
/// focus, frozen at the sound's phase psi,
///   n = 1 + background + amplitude / N sum_j cos(k d_j.(x - focus) - psi).
/// Directions in one plane focus on the line through the focus across that plane, a cone of them on
/// a point.
class FocusedSound : public SoundWaves {
 public:
  /// One direction at least, of any lengths but 0; k > 0.
  FocusedSound(double background, double amplitude, double k, const std::vector<Vec3>& directions,
               const Vec3& focus, double psi = 0);

  /// The wave that a ray meets at another phase of the sound.
  FocusedSound frozen(double psi) const;

  /// Of one wave.
  double amplitude() const { return waves_.front().amplitude; }
  double wavenumber() const { return k_; }

 private:
  double k_, psi_;
};

/// `count` directions in the x-z plane, evenly over the angles from -aperture to aperture to the z
/// axis: a line focus along y.
std::vector<Vec3> arc_directions(int count, double aperture);

/// `count` directions spread evenly over the cap of that half-angle about the z axis: a point
/// focus.
std::vector<Vec3> cap_directions(int count, double aperture);

/// As light meets it at this phase of the sound.
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

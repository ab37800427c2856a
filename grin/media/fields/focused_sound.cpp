#include "grin/media/fields/focused_sound.h"

#include <cmath>
#include <numbers>

namespace flatspeckle::grin {

namespace {
using std::numbers::pi;
}

FocusedSound::FocusedSound(double background, double amplitude, double k,
                           const std::vector<Vec3>& directions, const Vec3& focus, double psi)
    : SoundWaves(background), k_(k), psi_(psi) {
  const double share = amplitude / static_cast<double>(directions.size());
  for (const Vec3& direction : directions) {
    const Vec3 wave = k * direction.normalized();
    waves_.push_back({wave, share, wave.dot(focus) + psi, 1});
  }
}

FocusedSound FocusedSound::frozen(double psi) const {
  FocusedSound sound = *this;
  for (Wave& wave : sound.waves_) wave.phase += psi - psi_;
  sound.psi_ = psi;
  return sound;
}

std::vector<Vec3> arc_directions(int count, double aperture) {
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double angle = aperture * ((2 * i + 1.0) / count - 1);
    directions.emplace_back(std::sin(angle), 0, std::cos(angle));
  }
  return directions;
}

/// Places the directions on a Fibonacci spiral.
std::vector<Vec3> cap_directions(int count, double aperture) {
  const double golden_angle = pi * (3 - std::sqrt(5.0));
  const double half_sine = std::sin(aperture / 2);
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    // 1 - cosine of the angle to the z axis
    const double drop = 2 * half_sine * half_sine * (i + 0.5) / count;
    const double radius = std::sqrt(drop * (2 - drop)), azimuth = golden_angle * i;
    directions.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth), 1 - drop);
  }
  return directions;
}

void add_keys(Keys& keys, FocusedSoundValues& values) {
  add_keys(keys, static_cast<SoundValues&>(values));
  keys.add("emitters", values.emitters, "Number of plane waves").from(1, 100'000);
  keys.add("aperture", values.aperture,
           "Largest angle between the directions of the plane waves and z")
      .positive_to(pi)
      .unit("rad");
  keys.add("focusing", values.focusing,
           "cone: directions about z, which focus at a point; arc: directions in the x-z plane, "
           "which focus on a line along y")
      .one_of({"cone", "arc"});
  add_vector(keys, "centre", values.centre, "Position of the focus").unit("length");
}

FocusedSound make_field(const Keys& keys, const FocusedSoundValues& values, const FieldUse& use) {
  const auto spread = keys.read(values.focusing) == "arc" ? arc_directions : cap_directions;
  return {background(keys, values.index, use),
          amplitude_of(keys, values),
          wavenumber_of(keys, values, use),
          spread(static_cast<int>(keys.read(values.emitters)), keys.read(values.aperture)),
          vector_of(keys.read(values.centre)),
          phase_of(keys, values, use)};
}

}  // namespace flatspeckle::grin

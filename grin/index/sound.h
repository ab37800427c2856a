#pragma once

#include "grin/index/field_kind.h"

namespace flatspeckle::grin {

// What fields of sound have in common: they are added to an index, and frozen at a phase.

struct SoundValues {
  static constexpr bool is_medium = false;
  double index = 1;
  std::optional<double> amplitude = {}, sound_wavenumber = {};
  double sound_phase = 0;
};

inline void add_keys(Keys& keys, SoundValues& values) {
  add_index_key(keys, values.index, "without the sound");
  keys.add("amplitude", values.amplitude, "Of the index");
  keys.add("sound_wavenumber", values.sound_wavenumber, "2 pi frequency / speed of the sound")
      .positive()
      .unit("1/length");
  keys.add("sound_phase", values.sound_phase, "Phase at which the sound is frozen").unit("rad");
}

inline double phase_of(const Keys& keys, const SoundValues& values, const FieldUse& use) {
  return use.any_phase ? 0 : keys.read(values.sound_phase);
}

}  // namespace flatspeckle::grin

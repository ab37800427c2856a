#pragma once

#include <numbers>

#include "grin/media/index/field_kind.h"

namespace flatspeckle::grin {

// Common parts of sound fields. The sound modulates the index; its phase is constant while light
// crosses it.

struct SoundValues {
  static constexpr bool is_medium = false;
  double index = 1;
  std::optional<double> amplitude = {}, sound_wavenumber = {};
  /// Sound pressure (Pa) and frequency (Hz), instead of amplitude and sound_wavenumber.
  std::optional<double> pressure = {}, frequency = {};
  double piezo_optic = 1.402e-10, sound_speed = 1500;  ///< defaults for water
  double sound_phase = 0;
};

inline void add_keys(Keys& keys, SoundValues& values) {
  add_index_key(keys, values.index, "without the sound");
  keys.add("amplitude", values.amplitude, "Amplitude of the index modulation");
  keys.add("pressure", values.pressure, "Amplitude of the sound pressure, instead of amplitude")
      .unit("Pa");
  keys.add("piezo_optic", values.piezo_optic, "Change of the index per pressure").unit("1/Pa");
  keys.add("sound_wavenumber", values.sound_wavenumber, "2 pi frequency / speed of sound")
      .positive()
      .unit("1/length");
  keys.add("frequency", values.frequency,
           "Frequency of the sound, instead of sound_wavenumber; requires length_unit")
      .positive()
      .unit("Hz");
  keys.add("sound_speed", values.sound_speed, "Speed of sound, used with frequency")
      .positive()
      .unit("m/s");
  keys.add("sound_phase", values.sound_phase, "Phase at which the sound is frozen").unit("rad");
}

inline double amplitude_of(const Keys& keys, const SoundValues& values) {
  const auto& pressure = keys.read(values.pressure);
  const auto& amplitude = keys.read(values.amplitude);
  if (!pressure && !amplitude) throw InputError("amplitude or pressure: give one of them");
  if (!pressure) return *amplitude;
  if (amplitude)
    throw InputError("pressure", *pressure, "must not be given together with amplitude");
  return *pressure * keys.read(values.piezo_optic);
}

inline double wavenumber_of(const Keys& keys, const SoundValues& values, const FieldUse& use) {
  const auto& frequency = keys.read(values.frequency);
  const auto& wavenumber = keys.read(values.sound_wavenumber);
  if (!frequency && !wavenumber)
    throw InputError("frequency or sound_wavenumber: give one of them");
  if (!frequency) return *wavenumber;
  if (wavenumber)
    throw InputError("frequency", *frequency, "must not be given together with sound_wavenumber");
  if (!use.length_unit)
    throw InputError("frequency", *frequency, "requires length_unit, the unit of length in metres");
  return 2 * std::numbers::pi * *frequency / keys.read(values.sound_speed) * *use.length_unit;
}

inline double phase_of(const Keys& keys, const SoundValues& values, const FieldUse& use) {
  return use.any_phase ? 0 : keys.read(values.sound_phase);
}

}  // namespace flatspeckle::grin

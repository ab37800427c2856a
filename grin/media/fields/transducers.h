#pragma once

#include <string>
#include <vector>

#include "grin/media/index/sound.h"
#include "grin/media/index/sound_waves.h"

namespace flatspeckle::grin {

/// A transducer and its sound about the focus, in the far-field approximation: plane waves of equal
/// strength, all in phase at the focus. Their directions are evenly distributed over a spherical
/// cap; a transducer with aperture 0 emits one plane wave.
struct Transducer {
  double amplitude;   ///< amplitude of the index at the focus
  double wavenumber;  ///< wavenumber of the sound, 1/length
  double phase;       ///< phase of the sound at the focus
  Vec3 focus, direction;
  double aperture;  ///< half-angle, rad
};

/// Sound of several transducers at a time t: n = 1 + background + sum of amplitude cos(k d . (x -
/// focus) - phase - psi_j) over all waves. d is the direction of a wave, and psi_j = w_j t for
/// transducer j with the angular frequency w_j.
class Transducers : public SoundWaves {
 public:
  /// waves: number of plane waves of each transducer that has an aperture.
  Transducers(double background, const std::vector<Transducer>& all, int waves);

  /// Returns the field at a time determined by `phase`, from 0 to 2 pi. For a single frequency,
  /// `phase` is the phase of the sound. For several frequencies, it selects a time within 2^20
  /// periods of the highest frequency.
  Transducers frozen(double phase) const;

  double largest_wavenumber() const { return largest_wavenumber_; }

 private:
  double largest_wavenumber_ = 0;
};

inline Transducers at_phase(const Transducers& field, double phase) {
  return field.frozen(phase);
}

inline FieldFacts facts(const Transducers& field) {
  return {.scale = 1 / field.largest_wavenumber(), .strength = field.largest()};
}

struct TransducersValues {
  using Field = Transducers;
  static constexpr const char* word = "transducers";
  static constexpr bool is_medium = false;
  double index = 1;
  std::vector<double> transducer{};
  std::string transducer_table{};
  std::int64_t transducer_waves = 16;
};

void add_keys(Keys& keys, TransducersValues& values);
/// Makes the field from its scene keys. Throws InputError for invalid values.
Transducers make_field(const Keys& keys, const TransducersValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin

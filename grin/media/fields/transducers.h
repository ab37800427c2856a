#pragma once

#include <string>
#include <vector>

#include "grin/media/index/sound.h"
#include "grin/media/index/sound_waves.h"

namespace flatspeckle::grin {

/// Sound of a transducer about the point that it is aimed at, in its far field: plane waves of
/// equal strength, evenly over a cap of directions, all of the same phase at that point. Aperture
/// 0: one wave.
struct Transducer {
  double amplitude;   ///< of the index, at that point
  double wavenumber;  ///< of the sound, 1/length
  double phase;       ///< there
  Vec3 focus, direction;
  double aperture;  ///< half angle, rad
};

/// n = 1 + background + sum over all waves of amplitude cos(k d.(x - focus) - phase - psi_j), as
/// light meets it at a time t: psi_j = w_j t.
class Transducers : public SoundWaves {
 public:
  /// waves: of each transducer that has an aperture.
  Transducers(double background, const std::vector<Transducer>& all, int waves);

  /// At a phase, from 0 to 2 pi: of sound of one frequency, that; of several, where it finds them
  /// in a time of many periods.
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
/// Throws InputError.
Transducers make_field(const Keys& keys, const TransducersValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin

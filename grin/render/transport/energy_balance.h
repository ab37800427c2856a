#pragma once

#include <array>
#include <span>

#include "core/numbers/complex.h"

namespace flatspeckle::grin {

/// What becomes of the power of light. All but `emitted` add up to that.
enum class Fate {
  emitted,
  absorbed_stage,  ///< in the stage, but for bodies
  absorbed_body,   ///< in bodies
  unscattered,     ///< left the stage without a scattering
  specular,        ///< the same, reflected at the surface of a body without having entered
  scattered,       ///< left the stage after one or more
  lost,            ///< in flights that led nowhere (Flight::End::lost)
  cut              ///< of paths that reached max_scatterings
};
inline constexpr std::size_t fates = 8;
inline constexpr std::array<const char*, fates> fate_words{
    "emitted", "absorbed", "absorbed in bodies", "unscattered", "reflected by bodies", "scattered",
    "lost",    "cut"};

/// Power by Fate, summed over light paths. A path keeps its own until it has ended, so that sums
/// round little.
class EnergyBalance {
 public:
  static constexpr std::size_t size = fates;

  void add(Fate fate, double power) { power_[static_cast<std::size_t>(fate)] += power; }
  double of(Fate fate) const { return power_[static_cast<std::size_t>(fate)]; }

  EnergyBalance& operator+=(const EnergyBalance& other) {
    for (std::size_t i = 0; i < size; ++i) power_[i] += other.power_[i];
    return *this;
  }
  /// sums: [fate].
  void add_to(std::span<Complex> sums) const {
    for (std::size_t i = 0; i < size; ++i) sums[i] += power_[i];
  }

 private:
  std::array<double, size> power_{};
};

}  // namespace flatspeckle::grin

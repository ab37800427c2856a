#pragma once

#include "grin/media/scattering/space_phase.h"

namespace flatspeckle::grin {

/// Phase function of Henyey and Greenstein [henyey1941].
struct HgPhase {
  static constexpr const char* word = "henyey_greenstein";
  double g = 0;  ///< mean cosine of the scattering angle; |g| < 1

  double density(double cosine) const { return HenyeyGreenstein<3>{g}.density_at(cosine); }
  double one_minus_cosine(RandomStream& random) const {
    return HenyeyGreenstein<3>{g}.sample_one_minus_cosine(random.uniform());
  }
  double mean_cosine() const { return g; }
};

inline void add_keys(Keys& keys, HgPhase& phase, const std::string& prefix) {
  keys.add(prefix + "g", phase.g, "Mean cosine of the scattering angle")
      .between(-1, 1)
      .only_of(phase.word);
}
inline HgPhase make_phase(const Keys& keys, const HgPhase& phase) {
  return {keys.read(phase.g)};
}

}  // namespace flatspeckle::grin

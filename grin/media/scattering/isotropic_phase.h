#pragma once

#include "grin/media/scattering/space_phase.h"

namespace flatspeckle::grin {

struct IsotropicPhase {
  static constexpr const char* word = "isotropic";

  double density(double /*cosine*/) const { return Isotropic<3>::value; }
  double one_minus_cosine(RandomStream& random) const { return 2 * random.uniform(); }
  double mean_cosine() const { return 0; }
};

inline void add_keys(Keys&, IsotropicPhase&, const std::string&) {}
inline IsotropicPhase make_phase(const Keys&, const IsotropicPhase& phase) {
  return phase;
}

}  // namespace flatspeckle::grin

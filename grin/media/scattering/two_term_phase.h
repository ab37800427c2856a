#pragma once

#include <optional>

#include "grin/media/scattering/space_phase.h"

namespace flatspeckle::grin {

/// Mixture of two Henyey-Greenstein functions, a forward peak and a backward part, as used for
/// tissue and ice.
struct TwoTermPhase {
  HenyeyGreenstein<3> first, second;
  double share;  ///< weight of the first term

  double density(double cosine) const {
    return share * first.density_at(cosine) + (1 - share) * second.density_at(cosine);
  }
  double one_minus_cosine(RandomStream& random) const {
    const auto& term = random.uniform() < share ? first : second;
    return term.sample_one_minus_cosine(random.uniform());
  }
  double mean_cosine() const { return share * first.g + (1 - share) * second.g; }
};

struct TwoTermPhaseValues {
  static constexpr const char* word = "two_term_hg";
  std::optional<double> g = {}, g_back = {}, forward_share = {};
};

inline void add_keys(Keys& keys, TwoTermPhaseValues& values, const std::string& prefix) {
  keys.add(prefix + "g", values.g, "Mean cosine of the first term of phase = two_term_hg")
      .between(-1, 1)
      .only_of(values.word);
  keys.add(prefix + "g_back", values.g_back,
           "Mean cosine of the second term of phase = two_term_hg")
      .between(-1, 1)
      .only_of(values.word);
  keys.add(prefix + "forward_share", values.forward_share,
           "Weight of the first term (the one with g) of phase = two_term_hg")
      .from(0, 1)
      .only_of(values.word);
}
inline TwoTermPhase make_phase(const Keys& keys, const TwoTermPhaseValues& values) {
  return {{keys.required(values.g)},
          {keys.required(values.g_back)},
          keys.required(values.forward_share)};
}

}  // namespace flatspeckle::grin

#pragma once

#include <optional>

#include "core/keys/keys.h"
#include "flatland/scatterers/bulk_phase.h"

namespace flatspeckle {

/// Mixture of two Henyey-Greenstein functions of the plane (C22), as used for tissue and ice: a
/// forward peak and a backward part.
struct TwoTermHg {
  static constexpr const char* word = "two_term_hg";
  std::optional<double> g, g_back, forward_share;
};

inline void add_keys(Keys& keys, TwoTermHg& values) {
  keys.add("g", values.g, "Mean cosine of the first Henyey-Greenstein term")
      .between(-1, 1)
      .only_of(values.word)
      .swept();
  keys.add("g_back", values.g_back, "Mean cosine of the second Henyey-Greenstein term")
      .between(-1, 1)
      .only_of(values.word);
  keys.add("forward_share", values.forward_share, "Weight of the first term (the one with g)")
      .from(0, 1)
      .only_of(values.word);
}

inline BulkPhase make_phase(const Keys& keys, const TwoTermHg& values) {
  const double g1 = keys.required(values.g), g2 = keys.required(values.g_back),
               share = keys.required(values.forward_share);
  return {[=](double theta) {
            return share * henyey_greenstein(g1, theta) +
                   (1 - share) * henyey_greenstein(g2, theta);
          },
          share * g1 + (1 - share) * g2, ""};
}

}  // namespace flatspeckle

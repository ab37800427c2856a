#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "core/keys/kinds.h"
#include "flatland/scatterers/phase_table.h"
#include "flatland/scatterers/rayleigh.h"
#include "flatland/scatterers/two_term_hg.h"

namespace flatspeckle {

/// The phase functions, besides hg, that a scene may have instead of scatterers. Each is a type
/// with a `word`, add_keys() and make_phase(), in its own file.
using BulkPhases = std::tuple<TwoTermHg, PhaseTable, Rayleigh>;

inline void add_keys(Keys& keys, BulkPhases& all) {
  each_kind(all, [&](auto& one) { add_keys(keys, one); });
}

inline std::vector<std::string> bulk_phase_words() {
  return kind_words(BulkPhases{});
}

/// Returns the phase function that `word` names, or an empty one if `word` is not the word of one
/// of the BulkPhases. Throws InputError.
inline BulkPhase make_phase(const Keys& keys, const BulkPhases& all, const std::string& word) {
  BulkPhase phase;
  with_kind(all, word, [&](const auto& one) { phase = make_phase(keys, one); });
  return phase;
}

}  // namespace flatspeckle

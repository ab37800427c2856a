#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "core/keys/kinds.h"
#include "flatland/scatterers/phase_table.h"
#include "flatland/scatterers/rayleigh.h"
#include "flatland/scatterers/two_term_hg.h"

namespace flatspeckle {

/// The phase functions that a scene may have in place of scatterers, beside hg: each a type with a
/// word, keys and make_phase, in a file of its own. This is their list.
using BulkPhases = std::tuple<TwoTermHg, PhaseTable, Rayleigh>;

inline void add_keys(Keys& keys, BulkPhases& all) {
  each_kind(all, [&](auto& one) { add_keys(keys, one); });
}

inline std::vector<std::string> bulk_phase_words() {
  return kind_words(BulkPhases{});
}

/// That of this word. Throws InputError.
inline BulkPhase make_phase(const Keys& keys, const BulkPhases& all, const std::string& word) {
  BulkPhase phase;
  with_kind(all, word, [&](const auto& one) { phase = make_phase(keys, one); });
  return phase;
}

}  // namespace flatspeckle

#pragma once

#include <string>

#include "core/keys/keys.h"
#include "flatland/scatterers/bulk_phase.h"

namespace flatspeckle {

/// A phase function that was measured or computed elsewhere: a CSV file with columns angle
/// (radians, rising from 0 to pi) and value (not negative, in any unit), linear in between.
struct PhaseTable {
  static constexpr const char* word = "phase_table";
  std::string phase_table;
};

inline void add_keys(Keys& keys, PhaseTable& values) {
  keys.add("phase_table", values.phase_table,
           "CSV with columns angle (0 to pi) and value (any unit), linear in between")
      .only_of(values.word);
}

/// Throws InputError for a file that is no such table.
BulkPhase make_phase(const Keys& keys, const PhaseTable& values);

}  // namespace flatspeckle

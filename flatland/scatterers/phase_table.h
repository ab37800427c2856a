#pragma once

#include <string>

#include "core/keys/keys.h"
#include "flatland/scatterers/bulk_phase.h"

namespace flatspeckle {

/// Phase function that was measured or computed elsewhere. It is read from a CSV file with columns
/// angle (radians, increasing from 0 to pi) and value (not negative, in any unit), and is linear
/// between the angles.
struct PhaseTable {
  static constexpr const char* word = "phase_table";
  std::string phase_table;
};

inline void add_keys(Keys& keys, PhaseTable& values) {
  keys.add("phase_table", values.phase_table,
           "CSV with columns angle (0 to pi) and value (any unit), linear in between")
      .only_of(values.word);
}

/// Reads the file that phase_table names. Throws InputError if the file is not a table of this
/// form.
BulkPhase make_phase(const Keys& keys, const PhaseTable& values);

}  // namespace flatspeckle

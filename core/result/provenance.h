#pragma once

#include <cstdint>
#include <string>

#include "core/result/dataset_row.h"

namespace flatspeckle {

/// Origin and cost of a result, with all data needed to repeat the run.
struct Provenance {
  std::string command_line;
  std::string config;  ///< resolved scene file (TOML)
  std::uint64_t seed = 0;
  std::string plan;
  int threads = 1;
  std::string started;  ///< time at which the run started, from utc_now()
  double wall_s = 0, cpu_s = 0;
  double samples = 0;
  bool converged = false;  ///< whether the stop criteria were reached
  /// Text that must be equal for the run to be resumed; empty if it cannot be resumed.
  std::string identity = {};
};

extern const DatasetTable provenance_table;
/// Writes the members of Provenance, and program, version, git_commit and machine, as attributes of
/// the root. Call it after everything else is written, because the result counts as not converged
/// if datasets were left out (ResultFile::undefined()).
void write_provenance(ResultFile& file, const Provenance& provenance);

/// Returns the present time (UTC) as text, e.g. "2024-05-01T12:00:00Z".
std::string utc_now();

/// Returns processor model and number of cores as text, without the name of the machine.
std::string machine_description();

}  // namespace flatspeckle

#pragma once

#include <cstdint>
#include <string>

#include "core/result/dataset_row.h"

namespace flatspeckle {

/// Where a result came from and what it cost: enough to run it again.
struct Provenance {
  std::string command_line;
  std::string config;  ///< resolved TOML
  std::uint64_t seed = 0;
  std::string plan;
  int threads = 1;
  std::string started;  ///< utc_now() at the start
  double wall_s = 0, cpu_s = 0;
  double samples = 0;
  bool converged = false;     ///< reached what was asked for
  std::string identity = {};  ///< what a run that goes on must have in common; empty: cannot
};

extern const DatasetTable provenance_table;
/// Root attributes: the members of Provenance under their names, and program, version, git_commit,
/// machine. After all else: where something was left out (ResultFile::undefined), the result is not
/// converged.
void write_provenance(ResultFile& file, const Provenance& provenance);

/// "2024-05-01T12:00:00Z".
std::string utc_now();

/// Processor model and number of cores; nothing that names the machine itself.
std::string machine_description();

}  // namespace flatspeckle

#include "core/result/provenance.h"

#include <ctime>
#include <fstream>
#include <thread>

#include "core/result/result_group.h"
#include "core/result/version.h"

namespace flatspeckle {

const DatasetTable provenance_table{
    .name = "provenance",
    .rows = {},
    .attributes = {
        {"", "program", "text", "flatspeckle"},
        {"", "version", "text", "program version"},
        {"", "git_commit", "text", "commit of the build"},
        {"", "command_line", "text", "command line as typed"},
        {"", "config", "text", "resolved scene: pass it to --config to repeat the run"},
        {"", "seed", "uint64", "seed of all random numbers"},
        {"", "plan", "text", "how the numbers were computed, one line per run"},
        {"", "machine", "text", "processor and cores"},
        {"", "threads", "int64", "threads of the runs"},
        {"", "started", "text", "start time in UTC, 2024-05-01T12:00:00Z"},
        {"", "wall_s", "float64", "time taken by samples or solutions"},
        {"", "cpu_s", "float64", "processor time of all threads"},
        {"", "samples", "float64",
         "number of samples: light paths, placements, fields, rays, trials or camera paths"},
        {"", "identity", "text", "identity that --resume compares"},
        {"", "converged", "bool",
         "whether the stop criteria were reached; 0: stopped before the target error, or "
         "interrupted"},
        {"", "undefined", "texts", "datasets left out because a value is not finite"},
    }};

void write_provenance(ResultFile& file, const Provenance& provenance) {
  const ResultGroup root(file, provenance_table);
  root.attribute("program", "flatspeckle");
  root.attribute("version", version());
  root.attribute("git_commit", git_commit());
  root.attribute("command_line", provenance.command_line);
  root.attribute("config", provenance.config);
  root.attribute("seed", provenance.seed);
  root.attribute("plan", provenance.plan);
  root.attribute("machine", machine_description());
  root.attribute("threads", provenance.threads);
  root.attribute("started", provenance.started);
  root.attribute("wall_s", provenance.wall_s);
  root.attribute("cpu_s", provenance.cpu_s);
  root.attribute("samples", provenance.samples);
  root.attribute("converged", provenance.converged && file.undefined().empty());
  if (!file.undefined().empty()) root.attribute("undefined", file.undefined());
  if (!provenance.identity.empty()) root.attribute("identity", provenance.identity);
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[sizeof "2024-05-01T12:00:00Z"];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string machine_description() {
  std::string model = "unknown processor";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const auto colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    model = line.substr(colon + 2);
    break;
  }
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

}  // namespace flatspeckle

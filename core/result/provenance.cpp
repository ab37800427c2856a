#include "core/result/provenance.h"

#include <ctime>
#include <fstream>
#include <thread>

#include "core/result/version.h"

namespace flatspeckle {

void write_provenance(ResultFile& file, const Provenance& provenance) {
  file.attribute("/", "program", "flatspeckle");
  file.attribute("/", "version", version());
  file.attribute("/", "git_commit", git_commit());
  file.attribute("/", "command_line", provenance.command_line);
  file.attribute("/", "config", provenance.config);
  file.attribute("/", "seed", provenance.seed);
  file.attribute("/", "plan", provenance.plan);
  file.attribute("/", "machine", machine_description());
  file.attribute("/", "threads", provenance.threads);
  file.attribute("/", "started", provenance.started);
  file.attribute("/", "wall_s", provenance.wall_s);
  file.attribute("/", "cpu_s", provenance.cpu_s);
  file.attribute("/", "samples", provenance.samples);
  file.attribute("/", "converged", provenance.converged);
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

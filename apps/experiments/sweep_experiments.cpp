#include "apps/experiments/sweep_experiments.h"

#include <fstream>
#include <sstream>

#include "apps/command/scene_file.h"
#include "apps/experiments/experiment_sweep.h"
#include "apps/sweep/curve_sweep.h"
#include "core/error.h"

namespace flatspeckle::apps {

namespace {

/// The value of a flag, as --flag value or --flag=value; empty where it is not given.
std::string value_of(const Arguments& arguments, const std::string& flag) {
  for (std::size_t i = 2; i < arguments.size(); ++i) {
    if (arguments[i] == flag && i + 1 < arguments.size()) return arguments[i + 1];
    if (arguments[i].starts_with(flag + '=')) return arguments[i].substr(flag.size() + 1);
  }
  return "";
}

/// The key `of` of a scene file; whatever is wrong with the file shows when it is parsed.
std::string of_in(std::istream& scene) try {
  for (const CLI::ConfigItem& item : SceneFile().from_config(scene))
    if (item.name == "of" && item.inputs.size() == 1) return item.inputs.front();
  return "";
} catch (const InputError&) {
  return "";
}

}  // namespace

std::string swept_subcommand(const Arguments& arguments) {
  const std::string given = value_of(arguments, "--of");
  if (!given.empty()) return given;
  const std::string config = value_of(arguments, "--config");
  if (config.empty()) return "";
  std::ifstream file(config);
  return of_in(file);
}

std::unique_ptr<Sweep> make_sweep(const std::string& of) {
  if (of.empty()) return std::make_unique<CurveSweep>();
  return std::make_unique<ExperimentSweep>(of);
}

std::unique_ptr<Sweep> sweep_of_config(const std::string& config) {
  std::istringstream scene(config);
  return make_sweep(of_in(scene));
}

}  // namespace flatspeckle::apps

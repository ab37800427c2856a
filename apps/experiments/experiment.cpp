#include "apps/experiments/experiment.h"

#include <algorithm>

namespace flatspeckle::apps {

std::unique_ptr<Experiment> render_experiment();

namespace {

constexpr ExperimentEntry entries[] = {
    {"render",
     "Pictures of scattering media with a gradient index, in space: radiance that curves and "
     "scatters",
     render_experiment}};

}  // namespace

const ExperimentEntry* experiment_entry(const std::string& name) {
  const auto found = std::ranges::find_if(
      entries, [&](const ExperimentEntry& entry) { return name == entry.name; });
  return found == std::end(entries) ? nullptr : found;
}

std::vector<std::string> experiment_names() {
  std::vector<std::string> names;
  for (const ExperimentEntry& entry : entries) names.emplace_back(entry.name);
  return names;
}

}  // namespace flatspeckle::apps

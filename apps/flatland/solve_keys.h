#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/flatland/map_settings.h"
#include "apps/flatland/solver_keys.h"
#include "apps/results/wavelengths.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

/// Values of the keys of the subcommand `solve`.
struct SolveKeys : SolverKeys {
  SceneSpec spec;
  MapSettings map;
  SpectrumSettings spectrum;
  std::string cluster;
  std::optional<double> t_matrix_gap, period;
  std::vector<std::int64_t> map_eigenchannels = {0};
  std::string map_lights;
};

void add_solve_keys(Keys& keys, SolveKeys& values);

}  // namespace flatspeckle::apps

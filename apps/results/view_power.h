#pragma once

#include <cstdint>
#include <string>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

/// Method and effort with which a result was computed, for the check of its power balance.
struct DoneWork {
  std::string method;  ///< mc, transport or wave
  /// Number of light paths of the result; the check uses a few percent of this number.
  double samples = 0;
  double tolerance = 0;  ///< tolerance of transport or of exact solutions
  std::uint64_t seed = 0;
};

extern const DatasetTable power_table;
/// Checks the power balance of a scene by a computation separate from its result, with the first
/// light as a plane wave and without reversed paths, which only redistribute power. The power
/// scattered into all directions must equal the power that is neither transmitted unscattered nor
/// absorbed. For Monte Carlo, the power received by the scatterers must also equal the power lost
/// by the light (mc::PathPower). Writes the result of the check to `group` of the file (the root if
/// empty), or nothing if it is not possible for the medium.
void check_power(ResultFile& file, const std::string& group, const Scene& scene,
                 const DoneWork& work);

}  // namespace flatspeckle::apps

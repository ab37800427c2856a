#pragma once

#include <cstdint>
#include <string>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

/// How a result was made, as far as its check depends on it.
struct DoneWork {
  std::string method;    ///< mc, transport or wave
  double samples = 0;    ///< light paths, of which the check takes some percent as many
  double tolerance = 0;  ///< of transport, or of the fields of waves
  std::uint64_t seed = 0;
};

extern const DatasetTable power_table;
/// Checks the power of a result of this scene apart from the result: of its first light, as a plane
/// wave, without reversed paths, which only redistribute power. The power scattered into all
/// directions must be what neither passes unscattered nor is absorbed; of light paths also, what
/// scatterers along them receive must be what light loses (mc::PathPower). Writes nothing for media
/// to which this does not apply. group: of its method, or empty.
void check_power(ResultFile& file, const std::string& group, const Scene& scene,
                 const DoneWork& work);

}  // namespace flatspeckle::apps

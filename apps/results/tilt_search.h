#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/results/estimation.h"

namespace flatspeckle::apps {

void add_tilt_count_key(Keys& keys, std::optional<std::int64_t>& count);

/// If tilt_count is given instead of tilts, fills spec.tilts with this number of tilts and resets
/// `count`. The tilts range from 0 to twice the tilt at which the intensity correlation C_I is 1/2,
/// are equidistant in q (the change of the transverse wavenumber) and rounded to four digits. A
/// short run by transport or Monte Carlo with doubled tilts determines where C_I = 1/2. Throws
/// InputError.
void choose_tilts(const Keys& keys, std::optional<std::int64_t>& count, SceneSpec& spec,
                  const std::string& method, const RunSettings& run, std::uint64_t seed);

/// Adds the key q_depths, which gives tilts by q L, where q is the change of the transverse
/// wavenumber and L is the depth.
void add_q_depths_key(Keys& keys, std::vector<double>& q_depths);

/// If q_depths is given, fills spec.tilts with the corresponding tilts and clears the list
/// q_depths. Throws InputError.
void take_q_depths(const Keys& keys, std::vector<double>& q_depths, SceneSpec& spec);

}  // namespace flatspeckle::apps

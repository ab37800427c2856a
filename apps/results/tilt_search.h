#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/results/estimation.h"

namespace flatspeckle::apps {

void add_tilt_count_key(Keys& keys, std::optional<std::int64_t>& count);

/// Where a number of tilts is given in place of tilts: fills spec.tilts with as many, from 0 to
/// twice the tilt at which C_I has fallen to 1/2, even in q and to four digits, and empties the
/// number. That tilt is found by a pilot, of transport or of Monte Carlo, over tilts that double.
/// Throws InputError.
void choose_tilts(const Keys& keys, std::optional<std::int64_t>& count, SceneSpec& spec,
                  const std::string& method, const RunSettings& run, std::uint64_t seed);

/// q L of tilts, L the depth, in place of the tilts themselves.
void add_q_depths_key(Keys& keys, std::vector<double>& q_depths);

/// Where they are given: fills spec.tilts with the rotations that have them, and empties the list.
/// Throws InputError.
void take_q_depths(const Keys& keys, std::vector<double>& q_depths, SceneSpec& spec);

}  // namespace flatspeckle::apps

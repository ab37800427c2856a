#pragma once

#include <vector>

namespace flatspeckle::grin {

/// What joins promise to a sensor, and what those that are made bring, each over its chance.
struct JoinPromise {
  double joins = 0;  ///< made or not
  double made = 0, brought = 0;
  double hits = 0;   ///< what came without a join
  double beams = 0;  ///< what joins to beams brought
};

/// [pair of paths][sensor].
using JoinPromises = std::vector<JoinPromise>;

}  // namespace flatspeckle::grin

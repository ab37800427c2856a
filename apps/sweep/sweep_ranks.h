#pragma once

#include <functional>

#include "core/run/remote_batches.h"

namespace flatspeckle::apps {

/// A sweep by all processes that have joined: rank 0 leads, with a server to the others if there
/// are any, and they follow. Returns the exit status.
int on_all_ranks(const std::function<int(RankServer*)>& lead, const std::function<void()>& follow);

}  // namespace flatspeckle::apps

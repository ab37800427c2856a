#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "mc/paths/speckle/camera_sides.h"
#include "mc/paths/speckle/field_changes.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Receives an end and its factors under each light, which belong to successive fields from `field`
/// on.
using EndSink =
    std::function<void(const PathEnd& end, std::span<const Complex> factors, std::size_t field)>;

/// Passes the ends of all paths of a batch of walks to `sink`, after each change. The fields are
/// [change][light]. Each path has a factor sqrt(weight) exp(2 pi i U) with an independent U from
/// `random` (C17), and its reversed path the same.
void each_end(const PathWalks& walks, std::uint64_t batch, const FieldChanges& changes,
              const RandomStream& random, const EndSink& sink);

}  // namespace flatspeckle::mc

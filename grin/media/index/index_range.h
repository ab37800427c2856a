#pragma once

namespace flatspeckle::grin {

/// Of an index field, at places all over its part of the stage.
struct IndexRange {
  double lowest = 1, highest = 1;
};

}  // namespace flatspeckle::grin

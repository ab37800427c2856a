#pragma once

#include <string>
#include <vector>

#include "bench/error/error_measure.h"

namespace flatspeckle::bench {

/// A long run that stands for the truth; its name is that of a scene, or of a scene and a method.
struct LongRun {
  std::string name;
  std::string how;  ///< it was made, in words
  std::function<Trial(std::uint64_t seed)> trial;
};

/// From data/error_references.txt, which is compiled in: made by bench_error_references. Throws
/// std::out_of_range for a name that is not there.
ErrorReference stored_reference(const std::string& name);

}  // namespace flatspeckle::bench

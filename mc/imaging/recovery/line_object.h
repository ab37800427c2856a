#pragma once

#include <vector>

namespace flatspeckle::mc {

/// Points of light on a line, incoherent with each other. brightness: relative, positive.
struct LineObject {
  std::vector<double> x, brightness;
};

}  // namespace flatspeckle::mc

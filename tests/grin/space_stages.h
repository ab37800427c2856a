#pragma once

#include <memory>
#include <vector>

#include "core/numbers/random.h"
#include "grin/render/flights/space.h"

namespace flatspeckle::grin::tests {

/// Returns a relative density that varies by a factor of about 4, on a coarse grid that covers the
/// unit ball.
inline std::shared_ptr<const DensityGrid> random_density(std::uint64_t seed) {
  const FieldGrid grid{Vec3(-1.2, -1.1, -1.3), Vec3(0.4, 0.35, 0.5), {7, 8, 6}};
  RandomStream random(seed, 31, 0);
  std::vector<double> values(grid.size());
  for (double& value : values) value = 0.4 + 1.2 * random.uniform();
  return std::make_shared<const DensityGrid>(grid, values);
}

}  // namespace flatspeckle::grin::tests

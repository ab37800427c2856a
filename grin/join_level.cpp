#include "grin/join_level.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace flatspeckle::grin {

double join_level(std::vector<double> promised, double wanted) {
  if (static_cast<double>(promised.size()) <= wanted) return 0;
  std::sort(promised.begin(), promised.end(), std::greater<>());
  double rest = std::accumulate(promised.begin(), promised.end(), 0.0);
  double certain = 0;  // the largest of them are joined in any case
  for (const double largest : promised) {
    const double level = rest / (wanted - certain);
    if (largest <= level || certain + 1 >= wanted) return level;
    rest -= largest;
    ++certain;
  }
  return 0;
}

}  // namespace flatspeckle::grin

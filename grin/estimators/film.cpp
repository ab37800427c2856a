#include "grin/estimators/film.h"

#include <cassert>
#include <cmath>

#include "core/error.h"

namespace flatspeckle::grin {

void require_usable(const TimeBins& bins) {
  if (bins.count < 1) throw InputError("path_bins", bins.count, "must be at least 1");
  if (bins.count == 1) return;
  if (!(std::isfinite(bins.first) && std::isfinite(bins.last) && bins.first < bins.last))
    throw InputError("start of path_bins", bins.first, "must be finite and before their end");
}

Film::Film(int pixels, const TimeBins& bins, std::span<Complex> sums)
    : sums_(sums),
      count_(bins.count),
      first_(bins.first),
      bins_per_length_(bins.count > 1 ? bins.count / (bins.last - bins.first) : 0) {
  assert(sums.size() == static_cast<std::size_t>(pixels) * bins.count);
  (void)pixels;
}

}  // namespace flatspeckle::grin

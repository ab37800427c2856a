#include "grin/render/transport/film.h"

#include <cassert>

namespace flatspeckle::grin {

Film::Film(int pixels, const TimeBins& bins, std::span<Complex> sums)
    : sums_(sums),
      bins_(bins),
      per_pixel_(bins.sums()),
      bins_per_length_(bins.count > 1 ? bins.count / (bins.last - bins.first) : 0) {
  assert(sums.size() == static_cast<std::size_t>(pixels) * bins.sums());
  (void)pixels;
}

}  // namespace flatspeckle::grin

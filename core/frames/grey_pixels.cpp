#include <algorithm>
#include <stdexcept>

#include "core/frames/frame_formats.h"

namespace flatspeckle {

std::vector<double> grey_pixels(std::vector<double> values, std::size_t channels, double opaque) {
  if (channels == 1) return values;
  const bool has_alpha = channels % 2 == 0;
  std::vector<double> grey;
  grey.reserve(values.size() / channels);
  for (auto pixel = values.begin(); pixel != values.end();
       pixel += static_cast<std::ptrdiff_t>(channels)) {
    const auto end = pixel + static_cast<std::ptrdiff_t>(channels - (has_alpha ? 1 : 0));
    if (std::any_of(pixel, end, [&](double value) { return value != *pixel; }))
      throw std::runtime_error(
          "has colours: convert it to grey, for example in Python by "
          "PIL.Image.open(\"in.png\").convert(\"L\").save(\"out.png\")");
    if (has_alpha && *end != opaque) throw std::runtime_error("has transparent pixels");
    grey.push_back(*pixel);
  }
  return grey;
}

}  // namespace flatspeckle

#include "grin/render/pictures/sideband_results.h"

#include <algorithm>
#include <span>
#include <vector>

namespace flatspeckle::grin {

namespace {

/// Returns the sums of a pixel from `first` on, each divided by its light; 0 without light.
std::vector<Complex> shares_of(std::span<const Complex> pixel, const TimeBins& bins, int first,
                               int count) {
  Complex light = 0;
  for (int part = 0; part < bins.parts(); ++part) light += pixel[static_cast<std::size_t>(part)];
  std::vector<Complex> shares;
  for (int n = first; n < first + count; ++n)
    shares.push_back(light == 0.0 ? 0 : pixel[static_cast<std::size_t>(n)] / light);
  return shares;
}

Invariant balance_of(const SidebandResult& result, bool is_lit) {
  double kept = is_lit ? 0 : 1;
  for (const Complex& share : result.mean.value) kept += share.real();
  const double most_missing = result.modulation.value[0].real() / (2 * sidebands * sidebands);
  return {std::max({0.0, kept - 1, 1 - kept - most_missing}), 1e-9};
}

}  // namespace

SidebandResult sideband_result(const SensorPixels& pixels, std::size_t first_pixel,
                               const TimeBins& bins, const GroupedSums& sums) {
  const auto stride = static_cast<std::size_t>(bins.sums());
  const auto count = static_cast<std::size_t>(pixels.grid.count());
  const auto mean_of = [&](int first, int numbers) {
    return jackknife(sums, [&, first, numbers](double, std::span<const Complex> all) {
      std::vector<Complex> mean(stride);
      for (std::size_t pixel = 0; pixel < count; ++pixel)
        for (std::size_t n = 0; n < stride; ++n)
          mean[n] += pixels.share(pixel) * all[(first_pixel + pixel) * stride + n];
      return shares_of(mean, bins, first, numbers);
    });
  };
  SidebandResult found;
  found.mean = mean_of(bins.first_sideband(), sidebands);
  found.modulation = mean_of(bins.first_sideband() + sidebands, 1);
  found.pixels = jackknife(sums, [&](double, std::span<const Complex> all) {
    std::vector<Complex> list(sidebands * count);
    for (std::size_t pixel = 0; pixel < count; ++pixel) {
      const auto shares = shares_of(all.subspan((first_pixel + pixel) * stride, stride), bins,
                                    bins.first_sideband(), sidebands);
      for (std::size_t n = 0; n < sidebands; ++n) list[n * count + pixel] = shares[n];
    }
    return list;
  });
  const auto own = sums.total();
  const bool is_lit =
      std::any_of(own.begin() + static_cast<std::ptrdiff_t>(first_pixel * stride),
                  own.begin() + static_cast<std::ptrdiff_t>((first_pixel + count) * stride),
                  [](const Complex& sum) { return sum != 0.0; });
  found.balance = balance_of(found, is_lit);
  return found;
}

void write_sidebands(const ResultGroup& group, const SidebandResult& result) {
  group.put("image_sideband", result.pixels);
  group.put("mean_sideband", result.mean);
  group.put("mean_modulation", result.modulation);
}

}  // namespace flatspeckle::grin

#include "grin/render/pictures/decay_results.h"

#include <functional>
#include <numeric>
#include <span>
#include <vector>

namespace flatspeckle::grin {

namespace {

using Sums = std::span<const Complex>;

/// Returns the ratio of two sums; 0 without light.
Complex ratio(Complex part, Complex light) {
  return light == 0.0 ? 0 : part / light;
}

/// The intensity sums of one pixel or of a mean over pixels, with and without decay.
struct DecaySums {
  const TimeBins& bins;
  Sums sums;

  Complex light() const { return total(0); }
  Complex light(int delay) const { return total(bins.first_decay() + delay * bins.parts()); }
  Complex correlation(int delay) const { return ratio(light(delay), light()); }
  /// Returns the correlation of the light in a bin of optical path.
  Complex correlation(int delay, int bin) const {
    return ratio(at(bins.first_decay() + delay * bins.parts() + 1 + bin), at(1 + bin));
  }
  Complex transfer(int part) const { return ratio(at(bins.first_transfer() + part), light()); }
  Complex derivative(int part, int delay) const {
    return ratio(at(bins.first_decay_derivative() + part * bins.delays() + delay), light());
  }

 private:
  Complex at(int number) const { return sums[static_cast<std::size_t>(number)]; }
  Complex total(int first) const {
    const Sums own =
        sums.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(bins.parts()));
    return std::accumulate(own.begin(), own.end(), Complex());
  }
};

/// Calls f(row, column) for all rows and columns, and returns the list of the results.
template <class F>
std::vector<Complex> listed_by(int rows, int columns, const F& f) {
  std::vector<Complex> list;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) list.push_back(f(row, column));
  return list;
}

}  // namespace

DecayResult decay_result(const SensorPixels& pixels, std::size_t first_pixel, const TimeBins& bins,
                         const GroupedSums& sums) {
  const auto stride = static_cast<std::size_t>(bins.sums());
  const int count = pixels.grid.count(), delays = bins.delays(), parts = bins.decay_parts();
  const auto of_pixel = [=](Sums all, std::size_t pixel) {
    return all.subspan((first_pixel + pixel) * stride, stride);
  };
  using Of = std::function<std::vector<Complex>(const DecaySums&)>;
  const auto of_mean = [&](const Of& of) {
    return jackknife(sums, [&](double, Sums all) {
      std::vector<Complex> mean(stride);
      for (std::size_t pixel = 0; pixel < static_cast<std::size_t>(count); ++pixel)
        for (std::size_t n = 0; n < stride; ++n)
          mean[n] += pixels.share(pixel) * of_pixel(all, pixel)[n];
      return of({bins, mean});
    });
  };
  DecayResult found;
  found.pixels = jackknife(sums, [&](double, Sums all) {
    return listed_by(delays, count, [&](int delay, int pixel) {
      return DecaySums{bins, of_pixel(all, static_cast<std::size_t>(pixel))}.correlation(delay);
    });
  });
  found.mean = of_mean([&](const DecaySums& mean) {
    return listed_by(delays, 1, [&](int delay, int) { return mean.correlation(delay); });
  });
  if (bins.count > 1)
    found.bins = of_mean([&](const DecaySums& mean) {
      return listed_by(delays, bins.count,
                       [&](int delay, int bin) { return mean.correlation(delay, bin); });
    });
  found.transfer = of_mean([&](const DecaySums& mean) {
    return listed_by(parts, 1, [&](int part, int) { return mean.transfer(part); });
  });
  found.gradient = of_mean([&](const DecaySums& mean) {
    return listed_by(parts, delays,
                     [&](int part, int delay) { return mean.derivative(part, delay); });
  });
  return found;
}

void write_decay(const ResultGroup& group, const DecayResult& result) {
  group.put("image_correlation", result.pixels);
  group.put("mean_correlation", result.mean);
  if (!result.bins.value.empty()) group.put("pulse_correlation", result.bins);
  group.put("mean_transfer", result.transfer);
  group.put("correlation_gradient", result.gradient);
}

}  // namespace flatspeckle::grin

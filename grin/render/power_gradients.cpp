#include "grin/render/power_gradients.h"

#include "grin/paths/path_score.h"

namespace flatspeckle::grin {

namespace {

/// theta(samples, sums) of [parameter]: what `of` makes of the derivatives of all pixels.
template <class Of>
Estimate of_each_parameter(const TimeBins& bins, std::size_t first_pixel, std::size_t pixels,
                           const GroupedSums& sums, const Of& of) {
  const auto stride = static_cast<std::size_t>(bins.sums());
  const auto first = static_cast<std::size_t>(bins.first_derivative());
  return jackknife(sums, [&](double samples, std::span<const Complex> all) {
    std::vector<Complex> made;
    for (int parameter = 0; parameter < bins.derivatives; ++parameter) {
      std::vector<Complex> own;
      for (std::size_t pixel = first_pixel; pixel < first_pixel + pixels; ++pixel)
        own.push_back(all[pixel * stride + first + static_cast<std::size_t>(parameter)] / samples);
      of(own);
      made.insert(made.end(), own.begin(), own.end());
    }
    return made;
  });
}

}  // namespace

PowerGradients power_gradients(const Sensor& sensor, std::size_t first_pixel, const TimeBins& bins,
                               const GroupedSums& sums) {
  const SensorPixels pixels = pixels_of(sensor);
  const auto count = static_cast<std::size_t>(pixels.grid.count());
  const auto of_each = [&](const auto& of) {
    return of_each_parameter(bins, first_pixel, count, sums, of);
  };
  PowerGradients found{of_each([](std::vector<Complex>&) {}), of_each([&](std::vector<Complex>& v) {
                         Complex mean = 0;
                         for (std::size_t i = 0; i < count; ++i) mean += pixels.share(i) * v[i];
                         v = {mean};
                       })};
  const auto* disks = std::get_if<RadialDetector>(&sensor);
  if (!disks || disks->radii.empty()) return found;
  found.within = of_each([&](std::vector<Complex>& v) {
    for (std::size_t i = 0; i < count; ++i)
      v[i] = pixels.area * pixels.share(i) * v[i] + (i > 0 ? v[i - 1] : 0);
  });
  return found;
}

std::vector<std::string> gradient_names(const ScatteringMedium& medium) {
  std::vector<std::string> names;
  for (const MediumParameter parameter : parameters_of(medium)) names.push_back(name_of(parameter));
  return names;
}

}  // namespace flatspeckle::grin

#include "grin/render/power_gradients.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/paths/path_score.h"

namespace flatspeckle::grin {

namespace {

/// The pixels of a sensor among the sums of all.
struct PixelSums {
  const TimeBins& bins;
  std::size_t first_pixel, pixels;

  /// The sum of this number of each.
  std::vector<Complex> means(double samples, std::span<const Complex> all, int number) const {
    const auto stride = static_cast<std::size_t>(bins.sums());
    std::vector<Complex> own;
    for (std::size_t pixel = first_pixel; pixel < first_pixel + pixels; ++pixel)
      own.push_back(all[pixel * stride + static_cast<std::size_t>(number)] / samples);
    return own;
  }
};

/// Of [parameter of the medium]: what `of` makes of the derivatives of all pixels.
template <class Of>
Estimate by_medium(const PixelSums& pixels, const GroupedSums& sums, const Of& of) {
  return jackknife(sums, [&](double samples, std::span<const Complex> all) {
    std::vector<Complex> made;
    for (int parameter = 0; parameter < pixels.bins.derivatives; ++parameter) {
      auto own = pixels.means(samples, all, pixels.bins.first_derivative() + parameter);
      of(own);
      made.insert(made.end(), own.begin(), own.end());
    }
    return made;
  });
}

/// What each width of edges makes of a derivative, and the differences of each two of them,
/// [width or pair][entry].
using Widths = std::vector<std::vector<Complex>>;
void append_differences(Widths& widths) {
  for (std::size_t one = 0; one < edge_widths; ++one)
    for (std::size_t other = one + 1; other < edge_widths; ++other) {
      std::vector<Complex> difference = widths[one];
      for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= widths[other][i];
      widths.push_back(std::move(difference));
    }
}

/// How far a difference of two widths is from 0 beyond what chance makes of it, squared.
double excess(double difference, double error) {
  return std::max(0.0, difference * difference - error * error);
}

/// Of the estimates of Widths, entry after entry `count` apart: that of the width with the smallest
/// error. That has what the width does, as far as narrower ones tell: the largest difference from
/// one of them beyond chance, and as much as chance leaves open of that from the next.
void append_best(const Estimate& widths, std::size_t first, std::size_t count, Estimate& best) {
  const auto at = [&](std::size_t column) { return first + column * count; };
  std::size_t pair = edge_widths, chosen = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t one = 0; one + 1 < edge_widths; ++one) {
    const double unknown = widths.error[at(pair)];
    double bias = 0;
    for (std::size_t other = one + 1; other < edge_widths; ++other, ++pair)
      bias = std::max(bias, excess(widths.value[at(pair)].real(), widths.error[at(pair)]));
    const double error = std::hypot(widths.error[at(one)], unknown, std::sqrt(bias));
    if (!(error < least)) continue;
    least = error;
    chosen = one;
  }
  best.value.push_back(widths.value[at(chosen)]);
  best.error.push_back(least);
  best.rare.push_back(widths.rare.empty() ? 0 : widths.rare[at(chosen)]);
}

/// Of [parameter of the field].
template <class Of>
Estimate by_field(const PixelSums& pixels, const GroupedSums& sums, const Of& of) {
  constexpr std::size_t columns = edge_widths + edge_widths * (edge_widths - 1) / 2;
  const int parameters = pixels.bins.by_field / edge_widths;
  const Estimate all = jackknife(sums, [&](double samples, std::span<const Complex> all) {
    std::vector<Complex> made;
    for (int parameter = 0; parameter < parameters; ++parameter) {
      Widths widths;
      for (int width = 0; width < edge_widths; ++width) {
        const int number = pixels.bins.first_by_field() + parameter * edge_widths + width;
        of(widths.emplace_back(pixels.means(samples, all, number)));
      }
      append_differences(widths);
      for (const auto& one : widths) made.insert(made.end(), one.begin(), one.end());
    }
    return made;
  });
  const std::size_t count =
      parameters > 0 ? all.value.size() / (columns * static_cast<std::size_t>(parameters)) : 0;
  Estimate best;
  for (std::size_t parameter = 0; parameter < static_cast<std::size_t>(parameters); ++parameter)
    for (std::size_t i = 0; i < count; ++i)
      append_best(all, parameter * columns * count + i, count, best);
  return best;
}

}  // namespace

PowerGradients power_gradients(const Sensor& sensor, std::size_t first_pixel, const TimeBins& bins,
                               const GroupedSums& sums) {
  const SensorPixels pixels = pixels_of(sensor);
  const auto count = static_cast<std::size_t>(pixels.grid.count());
  const auto of_each = [&](const auto& of) {
    const PixelSums own{bins, first_pixel, count};
    Estimate all = by_medium(own, sums, of);
    append(all, by_field(own, sums, of));
    return all;
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

std::vector<std::string> gradient_names(const RenderScene& scene) {
  std::vector<std::string> names;
  if (scene.bins.derivatives > 0)
    for (const MediumParameter parameter : parameters_of(scene.stage.medium))
      names.push_back(name_of(parameter));
  for (const FieldParameter& of : scene.parameters) names.push_back(of.name);
  return names;
}

}  // namespace flatspeckle::grin

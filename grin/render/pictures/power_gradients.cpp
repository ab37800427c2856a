#include "grin/render/pictures/power_gradients.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "grin/render/sensors/sensor_edges.h"
#include "grin/render/transport/path_score.h"

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

/// What each width of edges makes of a derivative, and its differences from the next narrower ones,
/// [width or pair][entry].
using PowersByWidth = std::vector<std::vector<Complex>>;
constexpr std::size_t width_count = edge_widths;

/// use(width, a narrower one).
template <class Use>
void for_pairs(const Use& use) {
  constexpr std::size_t compared = 2;
  for (std::size_t one = 0; one < width_count; ++one)
    for (std::size_t other = one + 1; other < std::min(one + compared + 1, width_count); ++other)
      use(one, other);
}
void append_differences(PowersByWidth& widths) {
  for_pairs([&](std::size_t one, std::size_t other) {
    std::vector<Complex> difference = widths[one];
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= widths[other][i];
    widths.push_back(std::move(difference));
  });
}

/// How far a difference of two widths is from 0 beyond what chance makes of it, squared.
double excess(double difference, double error) {
  return std::max(0.0, difference * difference - error * error);
}

/// The squared error of each width that has a narrower one. It has what the width does, as far as
/// narrower ones tell: the largest difference from one of them beyond chance, and as much as chance
/// leaves open of that from the next.
std::array<double, width_count - 1> squared_errors(
    const std::function<double(std::size_t)>& value,
    const std::function<double(std::size_t)>& error) {
  std::array<double, width_count - 1> bias{}, squares{};
  std::size_t pair = width_count;
  for_pairs([&](std::size_t one, std::size_t other) {
    if (other == one + 1) squares[one] = std::pow(error(one), 2) + std::pow(error(pair), 2);
    bias[one] = std::max(bias[one], excess(value(pair), error(pair)));
    ++pair;
  });
  for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += bias[i];
  return squares;
}

/// Of the estimates of PowersByWidth, entry after entry `count` apart: the width with the smallest error.
void append_best(const Estimate& widths, std::size_t first, std::size_t count, Estimate& best) {
  const auto at = [&](std::size_t column) { return first + column * count; };
  const auto squares =
      squared_errors([&](std::size_t column) { return widths.value[at(column)].real(); },
                     [&](std::size_t column) { return widths.error[at(column)]; });
  const auto least = std::ranges::min_element(squares);
  const auto chosen = at(static_cast<std::size_t>(least - squares.begin()));
  best.value.push_back(widths.value[chosen]);
  best.error.push_back(std::sqrt(*least));
  best.rare.push_back(widths.rare.empty() ? 0 : widths.rare[chosen]);
}

/// Of [parameter of the field].
template <class Of>
Estimate by_field(const PixelSums& pixels, const GroupedSums& sums, const Of& of) {
  std::size_t columns = width_count;
  for_pairs([&](std::size_t, std::size_t) { ++columns; });
  const int parameters = pixels.bins.by_field / edge_widths;
  const Estimate all = jackknife(sums, [&](double samples, std::span<const Complex> all) {
    std::vector<Complex> made;
    for (int parameter = 0; parameter < parameters; ++parameter) {
      PowersByWidth widths;
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

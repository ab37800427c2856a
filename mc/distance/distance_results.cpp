#include <algorithm>
#include <cmath>

#include "core/result/result_group.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/distance/distance_job.h"
#include "mc/jobs/delay_results.h"

namespace flatspeckle::mc {

namespace {

/// Returns the estimates of f(values, layout, list), which appends its results to the list.
template <typename F>
Estimate estimated(const DistanceRequest& request, const GroupedSums& sums, const F& f) {
  return jackknife(sums, [&](double samples, std::span<const Complex> all) {
    const auto values = sample_mean(samples, all);
    std::vector<Complex> list;
    f(values, DistanceLayout(request, values.size()), list);
    return list;
  });
}

using List = std::vector<Complex>;

}  // namespace

DistanceEstimates distance_estimates(const DistanceRequest& request, const GroupedSums& sums) {
  constexpr double rounding = 1e-12;
  const Dynamics& dynamics = request.dynamics;
  DistanceEstimates found;
  const auto estimate = [&](const auto& f) { return estimated(request, sums, f); };
  found.power = estimate([](const List& values, const DistanceLayout& of, List& list) {
    list.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(of.detectors));
  });
  found.reflectance = estimate([&](const List& values, const DistanceLayout& of, List& list) {
    for (std::size_t d = 0; d < of.detectors; ++d)
      list.push_back(values[d] / request.detectors[d].area());
  });
  const auto correlation = [](const List& values, const DistanceLayout& of, std::size_t delay,
                              std::size_t detector) {
    return values[of(0, delay, detector)] / values[of(0, 0, detector)];
  };
  found.correlation = estimate([&](const List& values, const DistanceLayout& of, List& list) {
    for (std::size_t t = 1; t < of.delays; ++t)
      for (std::size_t d = 0; d < of.detectors; ++d) list.push_back(correlation(values, of, t, d));
  });
  for (double& error : found.correlation.error) error = std::max(error, rounding);
  found.intensity = estimate([&](const List& values, const DistanceLayout& of, List& list) {
    for (std::size_t t = 1; t < of.delays; ++t)
      for (std::size_t d = 0; d < of.detectors; ++d)
        list.push_back(dynamics.exposure.beta * std::norm(correlation(values, of, t, d)));
  });
  found.contrast = estimate([&](const List& values, const DistanceLayout& of, List& list) {
    std::vector<double> squares(dynamics.delays.size());
    for (const double time : dynamics.exposure.times)
      for (std::size_t d = 0; d < of.detectors; ++d) {
        for (std::size_t t = 0; t < squares.size(); ++t)
          squares[t] = std::norm(correlation(values, of, t + 1, d));
        list.push_back(dynamics.exposure.beta * exposed(dynamics.delays, squares, time));
      }
  });
  found.power_gradient = estimate([](const List& values, const DistanceLayout& of, List& list) {
    for (std::size_t part = 1; part < of.parts; ++part)
      for (std::size_t d = 0; d < of.detectors; ++d) list.push_back(values[of(part, 0, d)]);
  });
  found.layer_path = estimate([](const List& values, const DistanceLayout& of, List& list) {
    for (std::size_t by_mu_a = 1; by_mu_a < of.parts; by_mu_a += layer_coefficients)
      for (std::size_t d = 0; d < of.detectors; ++d)
        list.push_back(-values[of(by_mu_a, 0, d)] / values[of(0, 0, d)]);
  });
  found.correlation_gradient =
      estimate([&](const List& values, const DistanceLayout& of, List& list) {
        for (std::size_t part = 1; part < of.parts; ++part)
          for (std::size_t t = 1; t < of.delays; ++t)
            for (std::size_t d = 0; d < of.detectors; ++d)
              list.push_back((values[of(part, t, d)] -
                              correlation(values, of, t, d) * values[of(part, 0, d)]) /
                             values[of(0, 0, d)]);
      });
  return found;
}

const DatasetTable distance_table{
    "light at a distance",
    {{"distance", Data::scale, "", "length", "distance of a detector from the axis of the beam"},
     {"detected_power", Data::estimate, "distance", "1",
      "power on a detector, as a fraction of the incident power"},
     {"distance_reflectance", Data::estimate, "distance", "1/length^2",
      "power on a detector per area, as a fraction of the incident power"},
     {"distance_correlation", Data::estimate, "delay distance", "1",
      "field correlation after a delay, g1"},
     {"distance_intensity_correlation", Data::estimate, "delay distance", "1",
      "correlation of intensities after a delay, g2 - 1 = beta g1^2"},
     {"exposure", Data::scale, "", "DELAY", "exposure time T, in the unit of the delays"},
     {"distance_contrast", Data::estimate, "exposure distance", "1",
      "squared speckle contrast K^2 for an exposure time"},
     {"layer_number", Data::numbers, "", "1", "number of a layer, from the top"},
     {"coefficient", Data::numbers, "", "1",
      "coefficient of a layer: 0: mu_a; 1: mu_s; 2: factor on the diffusion constant"},
     {"power_gradient", Data::estimate, "layer_number coefficient distance", "",
      "derivative of detected_power by a coefficient of a layer"},
     {"layer_path", Data::estimate, "layer_number distance", "length",
      "mean path of the detected light in a layer (partial path length)"},
     {"correlation_gradient", Data::estimate, "layer_number coefficient delay distance", "",
      "derivative of distance_correlation by a coefficient of a layer"},
     {"invariants/reciprocity", Data::invariant, "distance", "1",
      "relative difference of the power from that of the radiance at the surface"}},
    {{"", "numerical_aperture", "float64", "numerical aperture of the detectors"},
     {"", "length_unit", "float64", "metres in a unit of length, if given"}}};

void write_distance(ResultFile& file, const DistanceRequest& request,
                    const DistanceEstimates& found) {
  const ResultGroup root(file, distance_table);
  root.attribute("numerical_aperture", request.numerical_aperture);
  if (request.length_unit) root.attribute("length_unit", *request.length_unit);
  root.put("distance", column(request.detectors, &DistanceDetector::distance));
  root.put("detected_power", found.power);
  root.put("distance_reflectance", found.reflectance);
  const Dynamics& dynamics = request.dynamics;
  if (!dynamics.delays.empty()) {
    write_delay_axis(file, dynamics);
    root.put("distance_correlation", found.correlation);
    root.put("distance_intensity_correlation", found.intensity);
  }
  if (!dynamics.exposure.times.empty()) {
    root.put("exposure", dynamics.exposure.times);
    root.put("distance_contrast", found.contrast);
  }
  if (!request.gradient) return;
  root.number("layer_number",
              found.power_gradient.value.size() / (layer_coefficients * request.detectors.size()));
  root.number("coefficient", layer_coefficients);
  root.put("power_gradient", found.power_gradient);
  root.put("layer_path", found.layer_path);
  if (!dynamics.delays.empty()) root.put("correlation_gradient", found.correlation_gradient);
}

}  // namespace flatspeckle::mc

#include "grin/render/pictures/render_datasets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "core/numbers/constants.h"
#include "core/result/result_group.h"
#include "grin/rays/marching/ray.h"
#include "grin/render/pictures/render_job.h"
#include "grin/render/sensors/sensor_edges.h"
#include "grin/render/transport/path_score.h"

namespace flatspeckle::grin {

namespace {

/// Locates the sums of one sensor's pixels among the sums of all sensors.
struct PixelSums {
  const TimeBins& bins;
  std::size_t first_pixel, pixels;

  /// Returns the mean of sum `number` of each pixel.
  std::vector<Complex> means(double samples, std::span<const Complex> all, int number) const {
    const auto stride = static_cast<std::size_t>(bins.sums());
    std::vector<Complex> own;
    for (std::size_t pixel = first_pixel; pixel < first_pixel + pixels; ++pixel)
      own.push_back(all[pixel * stride + static_cast<std::size_t>(number)] / samples);
    return own;
  }
};

/// Estimates, for each parameter of the medium, the values that `of` computes from the derivatives
/// of all pixels.
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

/// Derivatives for each smoothing width of pixel edges, then the differences between pairs of
/// widths (for_pairs): [width or pair][entry].
using PowersByWidth = std::vector<std::vector<Complex>>;
constexpr std::size_t width_count = edge_widths;

/// Calls use(width, narrower width) for all compared pairs.
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

/// Returns the part of the squared difference between two widths that exceeds its squared
/// statistical error.
double excess(double difference, double error) {
  return std::max(0.0, difference * difference - error * error);
}

/// Returns the squared error of each width except the narrowest. It is the sum of three squares:
/// the statistical error of the value, that of its difference from the next narrower width, and the
/// bias, which is the largest difference from narrower widths in excess of its statistical error.
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

/// Appends to `best`, for one entry, the estimate at the smoothing width with the smallest error.
/// In `widths` the estimates of this entry at successive widths are `count` apart (PowersByWidth).
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

/// Estimates, for each parameter of the field, the values that `of` computes from the derivatives
/// of all pixels.
template <class Of>
Estimate by_field(const PixelSums& pixels, const GroupedSums& sums, const Of& of) {
  std::size_t columns = width_count;
  for_pairs([&](std::size_t, std::size_t) { ++columns; });
  const int parameters = pixels.bins.by_field / edge_widths;
  const Estimate every = jackknife(sums, [&](double samples, std::span<const Complex> all) {
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
      parameters > 0 ? every.value.size() / (columns * static_cast<std::size_t>(parameters)) : 0;
  Estimate best;
  for (std::size_t parameter = 0; parameter < static_cast<std::size_t>(parameters); ++parameter)
    for (std::size_t i = 0; i < count; ++i)
      append_best(every, parameter * columns * count + i, count, best);
  return best;
}

/// Whether a termination is possible in a scene.
bool can_be(Termination termination, const RenderScene& scene, const RenderRequest& request) {
  if (termination == Termination::absorbed_body || termination == Termination::specular)
    return !scene.stage.bodies.empty();
  return termination != Termination::cut || request.max_scatterings > 0;
}

/// The pixels of one sensor, the number of the first among the pixels of all sensors, and the
/// layout of their sums.
struct Pixels {
  SensorPixels of;
  std::size_t first;
  TimeBins bins;

  std::size_t count() const { return static_cast<std::size_t>(of.grid.count()); }
  std::size_t sums() const { return static_cast<std::size_t>(bins.sums()); }
  std::size_t parts() const { return static_cast<std::size_t>(bins.parts()); }
};

Complex sum(std::span<const Complex> values) {
  return std::accumulate(values.begin(), values.end(), Complex());
}

/// Returns the entries of one sensor from an estimate for all sensors. per_pixel: number of entries
/// per pixel.
Estimate own_part(const Estimate& all, const Pixels& pixels, std::size_t per_pixel) {
  if (all.value.empty()) return {};
  Estimate own = part(all, pixels.first * per_pixel, pixels.count() * per_pixel);
  bound_errors(own, pixels.of.grid);
  return own;
}

/// Applies theta to the sums over all pixels of a sensor, weighted by their shares of the area.
Estimator of_all_pixels(const Pixels& pixels, const Estimator& theta) {
  return [=](double samples, std::span<const Complex> all) {
    std::vector<Complex> means(pixels.sums());
    const auto own = all.subspan(pixels.first * pixels.sums(), pixels.count() * pixels.sums());
    for (std::size_t i = 0; i < own.size(); ++i)
      means[i % pixels.sums()] += pixels.of.share(i / pixels.sums()) * own[i];
    return theta(samples, means);
  };
}

Estimate scaled(Estimate one, double factor) {
  for (Complex& value : one.value) value *= factor;
  for (double& error : one.error) error *= factor;
  return one;
}

Estimate bounded(Estimate whole) {
  bound_errors(whole, {1, 1});
  return whole;
}

void add_pulses(SensorResult& result, const RenderJob& job, const GroupedSums& sums,
                const Pixels& pixels, double factor) {
  const auto means = [&](double samples, std::span<const Complex> all) {
    return sample_mean(samples / factor, all.first(pixels.parts()));
  };
  const Estimate parts = job.estimate(sums, of_all_pixels(pixels, means));
  const std::size_t bins = pixels.parts() - 2;
  result.pulse_before = bounded(part(parts, 0, 1));
  result.pulse = bounded(part(parts, 1, bins));
  result.pulse_after = bounded(part(parts, 1 + bins, 1));
}

/// Returns mean and mean squared optical path from sums that contain moments; 0 without light.
std::array<Complex, 2> path_means(const Pixels& pixels, std::span<const Complex> sums) {
  const Complex light = sum(sums.first(pixels.parts()));
  if (light == 0.0) return {};
  return {sums[pixels.parts()] / light, sums[pixels.parts() + 1] / light};
}

void add_paths(SensorResult& result, const GroupedSums& sums, const Pixels& pixels) {
  const auto means = [&](double, std::span<const Complex> all) {
    const auto [mean, square] = path_means(pixels, all);
    return std::vector{mean, square};
  };
  result.paths = jackknife(sums, of_all_pixels(pixels, means));
  result.pixel_paths = jackknife(sums, [&](double, std::span<const Complex> all) {
    std::vector<Complex> of_pixels;
    for (std::size_t i = pixels.first; i < pixels.first + pixels.count(); ++i) {
      const auto own = path_means(pixels, all.subspan(i * pixels.sums(), pixels.sums()));
      of_pixels.insert(of_pixels.end(), own.begin(), own.end());
    }
    return of_pixels;
  });
}

SensorResult sensor_result(const DatasetTable& table, const Pixels& pixels, const RenderJob& job,
                           const RenderedPicture& all, const LightCheck& check,
                           const GroupedSums& sums, const GroupedSums& steady) {
  SensorResult result{.picture = {.bins = own_part(all.bins, pixels, pixels.bins.count),
                                  .steady = own_part(all.steady, pixels, 1),
                                  .before = own_part(all.before, pixels, 1),
                                  .after = own_part(all.after, pixels, 1)},
                      .mean = bounded(sensor_mean(job, steady, check, pixels.first, pixels.of))};
  const bool has_total = has_row(table, "total");
  if (has_total) result.total = scaled(result.mean, pixels.of.area);
  if (pixels.bins.count > 1) add_pulses(result, job, sums, pixels, has_total ? pixels.of.area : 1);
  if (pixels.bins.moments) add_paths(result, sums, pixels);
  return result;
}

void write_bins(const ResultGroup& root, const TimeBins& bins,
                const std::optional<double>& length_unit) {
  std::vector<double> paths;
  for (int bin = 0; bin < bins.count; ++bin)
    paths.push_back(bins.first + (bins.last - bins.first) * (bin + 0.5) / bins.count);
  root.put("optical_path", paths);
  if (length_unit)
    root.put("time", column(paths, [&](double path) { return path * *length_unit / light_speed; }));
}

/// Writes `pairs` of mean and mean squared optical path as two datasets, one for each.
void put_paths(const ResultGroup& group, const std::string& name, const Estimate& pairs) {
  for (const bool square : {false, true}) {
    Estimate one;
    for (std::size_t i = square; i < pairs.value.size(); i += 2) append(one, part(pairs, i, 1));
    group.put(name + (square ? "_path_square" : "_path"), one);
  }
}

void write_gradients(const ResultGroup& group, const SensorPixels& pixels, bool has_total,
                     const PowerGradients& gradients) {
  group.put("image_gradient", gradients.image);
  group.put("mean_gradient", gradients.mean);
  if (has_total) group.put("total_gradient", scaled(gradients.mean, pixels.area));
  if (!gradients.within.value.empty()) group.put("power_within_gradient", gradients.within);
}

void write_sensor(const ResultGroup& group, const SensorPixels& pixels,
                  const SensorResult& result) {
  for (const auto& [name, middles] : pixels.axes) group.put(name, middles);
  group.put("image", result.picture.steady);
  group.put("mean", result.mean);
  if (result.total) group.put("total", *result.total);
  if (result.within) {
    group.put("disk_radius", result.within->radii);
    group.put("other_disk_radius", result.within->radii);
    group.put("power_within", result.within->power);
    group.put("power_within_covariance", result.within->covariance);
  }
  if (result.gradients) write_gradients(group, pixels, result.total.has_value(), *result.gradients);
  if (result.decay) write_decay(group, *result.decay);
  if (result.sidebands) write_sidebands(group, *result.sidebands);
  if (!result.pulse.value.empty()) {
    group.put("transient", result.picture.bins);
    group.put("transient_before", result.picture.before);
    group.put("transient_after", result.picture.after);
    group.put("pulse", result.pulse);
    group.put("pulse_before", result.pulse_before);
    group.put("pulse_after", result.pulse_after);
  }
  if (result.paths.value.empty()) return;
  put_paths(group, "image", result.pixel_paths);
  put_paths(group, "mean", result.paths);
}

/// If the LightCheck of a sensor fails, raises the errors of the sensor to the deviation that the
/// check has found.
void widen_errors(const LightCheck& check, double area, SensorResult& result) {
  if (check.holds()) return;
  const auto widen = [](Estimate& one, double off) {
    one.error[0] = std::max(one.error[0], off);
    one.rare.assign(1, 1);
  };
  widen(result.mean, check.off);
  if (result.total) widen(*result.total, check.off * area);
  Estimate& pixels = result.picture.steady;
  for (double& error : pixels.error) error = std::max(error, check.off);
  pixels.rare.assign(pixels.error.size(), 1);
}

}  // namespace

void write_counts(ResultFile& file, const TransportCounts& counts) {
  const ResultGroup root(file, render_table);
  root.put("transport/flights", counts.flights);
  root.put("transport/lost_flights", counts.lost_flights);
  root.put("transport/joins", counts.connections_made);
  root.put("transport/lost_values", counts.lost_values);
  if (!counts.connections.pairs) return;
  write_trials(file, counts.connections);
  write_pairs(file, counts.connections);
}

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

const DatasetTable energy_table{
    "energy",
    {{"energy/emitted", Data::estimate, "", "1", "power of the lights, as sampled by light paths"},
     {"energy/absorbed_stage", Data::estimate, "", "1", "absorbed in the stage outside of bodies"},
     {"energy/absorbed_body", Data::estimate, "", "1", "absorbed in bodies"},
     {"energy/unscattered", Data::estimate, "", "1", "left the stage without a scattering"},
     {"energy/specular", Data::estimate, "", "1",
      "left the stage unscattered, reflected at the surface of a body without entering it"},
     {"energy/scattered", Data::estimate, "", "1", "left the stage after one or more scatterings"},
     {"energy/lost", Data::estimate, "", "1", "in flights that were lost (transport/lost_flights)"},
     {"energy/cut", Data::estimate, "", "1", "in paths that were cut by max_scatterings"},
     {"invariants/power", Data::invariant, "", "1",
      "relative difference between the sum of all terminations and the emitted power"}}};

std::optional<Estimate> energy_result(const RenderJob& job, const GroupedSums& sums) {
  if (!job.has_energy) return std::nullopt;
  return jackknife(sums, [first = job.pictures](double samples, std::span<const Complex> all) {
    return sample_mean(samples, all.subspan(first, EnergyBalance::size));
  });
}

Invariant power_balance(const RenderJob& job, const GroupedSums& sums) {
  constexpr double rounding = 1e-9;
  const Estimate ended =
      jackknife(sums, [first = job.pictures](double, std::span<const Complex> all) {
        const auto energy = all.subspan(first, EnergyBalance::size);
        const Complex all_terminations = std::reduce(energy.begin() + 1, energy.end());
        return std::vector<Complex>{energy[0] == 0.0 ? 0.0 : all_terminations / energy[0] - 1.0};
      });
  return {std::abs(ended.value[0]), outlier_errors(sums.groups()) * ended.error[0] + rounding};
}

void write_energy(ResultFile& file, const RenderScene& scene, const RenderRequest& request,
                  const Estimate& energy) {
  const ResultGroup root(file, energy_table);
  for (std::size_t termination = 0; termination < EnergyBalance::size; ++termination)
    if (can_be(static_cast<Termination>(termination), scene, request))
      root.put(energy_table.rows[termination].path, part(energy, termination, 1));
}

const DatasetTable render_table{
    .name = "render",
    .rows =
        {{"optical_path", Data::scale, "", "length", "middle of the bin of optical path"},
         {"time", Data::real, "optical_path", "s", "optical path over the speed of light"},
         {"parameter", Data::numbers, "", "1",
          "parameters of derivatives: see the attribute names"},
         {"delay", Data::scale, "", "1", "delay, as k^2 D tau"},
         {"sideband", Data::numbers, "", "1",
          "number of the sound's frequencies by which light is shifted, up or down"},
         {"body", Data::numbers, "", "1",
          "0: the stage outside of bodies; then the bodies, from the largest to the smallest"},
         {"transport/flights", Data::count, "", "1", "free flights from one event to the next"},
         {"transport/lost_flights", Data::count, "", "1",
          "lost flights: too long, trapped or into an index that is not positive; their light is "
          "missing"},
         {"transport/joins", Data::count, "", "1",
          "connections between vertices of light and sensor paths"},
         {"transport/lost_values", Data::count, "", "1",
          "contributions left out because they were not finite"},
         {"invariants/light", Data::invariant, "", "1",
          "relative difference between the mean of a sensor and that of the light paths that hit "
          "it, or, for path tracing, that of bidirectional tracing; largest over the sensors"},
         {"invariants/sidebands", Data::invariant, "", "1",
          "for each sensor: how far the sum of mean_sideband is above 1, or below 1 - "
          "mean_modulation / 32"}},
    .attributes = {
        {"", "length_unit", "float64", "metres in a unit of length, if given"},
        {"", "mesh_volume", "float64",
         "volume enclosed by body_mesh and mesh, whose triangles are curved between creases"},
        {"", "body_volume", "float64", "volume of the smooth bodies that replace them"},
        {"parameter", "names", "texts",
         "mu_s, mu_a and g, as far as the medium has them (gradient); numbers of the index "
         "field (gradient_by)"}}};

RenderResult render_result(const RenderScene& scene, const RenderJob& job,
                           const GroupedSums& sums) {
  const RenderedPicture all = rendered_picture(job, sums);
  const GroupedSums steady = steady_sums(job, sums);
  const std::vector<LightCheck> checks = light_checks(job, sums);
  RenderResult result;
  std::size_t first = 0;
  for (const Sensor& sensor : scene.sensors) {
    const LightCheck& check = checks[result.size()];
    const Pixels pixels{pixels_of(sensor), first, job.bins};
    result.push_back(sensor_result(table_of(sensor), pixels, job, all, check, sums, steady));
    widen_errors(check, pixels.of.area, result.back());
    result.back().within = powers_within(sensor, check, first, job, steady);
    if (job.bins.derivatives > 0 || job.bins.by_field > 0)
      result.back().gradients = power_gradients(sensor, first, job.bins, sums);
    if (job.bins.decay) result.back().decay = decay_result(pixels.of, first, job.bins, sums);
    if (job.bins.sound) result.back().sidebands = sideband_result(pixels.of, first, job.bins, sums);
    first += pixels.count();
  }
  return result;
}

void write_render(ResultFile& file, const RenderScene& scene, const RenderJob& job,
                  const RenderResult& result, const std::optional<double>& length_unit) {
  const ResultGroup root(file, render_table);
  if (length_unit) root.attribute("length_unit", *length_unit);
  double mesh_volume = 0, body_volume = 0;
  for (const Body& body : scene.stage.bodies)
    if (const auto* level = std::get_if<LevelSurface>(&body.surface)) {
      mesh_volume += level->meant_volume();
      body_volume += level->volume();
    }
  if (mesh_volume > 0) {
    root.attribute("mesh_volume", mesh_volume);
    root.attribute("body_volume", body_volume);
  }
  if (const auto names = gradient_names(scene); !names.empty()) {
    root.number("parameter", names.size());
    root.attribute("parameter", "names", names);
  }
  if (job.bins.decay) {
    root.put("delay", job.bins.decay->delays);
    root.number("body", job.bins.decay->parts());
  }
  if (job.bins.sound) root.number("sideband", sidebands);
  if (job.bins.count > 1) write_bins(root, job.bins, length_unit);
  for (std::size_t i = 0; i < result.size(); ++i)
    write_sensor({file, table_of(scene.sensors[i]),
                  result.size() > 1 ? "sensors/" + sensor_name(scene, i) : ""},
                 pixels_of(scene.sensors[i]), result[i]);
}

}  // namespace flatspeckle::grin

#include "grin/render/pictures/render_job.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <string>

#include "core/numbers/random.h"
#include "core/numbers/statistics.h"
#include "grin/media/index/lanes.h"
#include "grin/render/methods/method_choice.h"
#include "grin/render/pictures/map_datasets.h"
#include "grin/render/pictures/powers_within.h"

namespace flatspeckle::grin {

namespace {

/// Returns the number of paths per batch. It is large enough that summing pictures takes little of
/// the time, and small enough that a batch ends soon and the batches required for errors are soon
/// available; it is smaller for long paths. It is a power of two, so that rounding errors of the
/// flights do not change it.
int paths_per_batch(const Tracer& tracer, bool scatters, double cost_of_flight, std::size_t sums) {
  constexpr double most = 16384, flights_soon_made = 1024;
  const double fewest = std::clamp(flights_soon_made / tracer.flights_per_pair, 1.0, 32.0);
  constexpr double most_flights = 1 << 17;
  const double paths = std::clamp(static_cast<double>(sums) / (16 * cost_of_flight), fewest, most);
  const auto short_enough =
      static_cast<std::size_t>(std::min(paths, most_flights / tracer.flights_per_pair));
  const bool fills_lanes = tracer.method == RenderMethod::forward && scatters;
  const double many = fills_lanes ? 4 * lanes / tracer.flights_per_pair : 1;
  return static_cast<int>(
      std::max(std::bit_floor(short_enough), std::bit_ceil(static_cast<std::size_t>(many))));
}

/// Returns the number of paths per batch for which every batch has equally many sensor paths in
/// each pixel of the largest picture, so that pixels have no noise of counts; at least `paths`.
/// Light that can hit its sensors needs no sensor paths in light tracing, and pictures of very long
/// paths would take too long.
int paths_of_whole_pictures(const Tracer& tracer, int paths) {
  constexpr double most_flights = 1 << 26;
  const bool is_light = tracer.transport->strategies.short_sensor;
  int pixels = 1;
  for (const SensorEnd& sensor : tracer.transport->sensors)
    if (!is_light || !sensor.can_be_hit()) pixels = std::max(pixels, sensor.pixels().count());
  const int whole = (paths + pixels - 1) / pixels * pixels;
  return whole * tracer.flights_per_pair < most_flights ? whole : paths;
}

std::string described(const RenderScene& scene, const RenderRequest& request, RenderMethod method) {
  std::string text = method_word(method);
  if (!request.method && !scene.sensors.empty()) text += " (chosen by a pilot)";
  if (!has_finite_variance(scene, method))
    text +=
        std::string(" (no finite variance with ") +
        (method == RenderMethod::path ? "points or fibres in scattering media, or refracted beams"
                                      : "a pinhole in a scattering medium") +
        ": errors are unreliable)";
  return text + ": ";
}

/// Makes an estimator of `count` values for each pixel. use(samples, sums of the pixel, values of
/// the pixel) sets the values.
template <class Use>
Estimator for_each_pixel(std::size_t pictures, const TimeBins& bins, std::size_t count,
                         const Use& use) {
  const auto per_pixel = static_cast<std::size_t>(bins.sums());
  return [=](double samples, std::span<const Complex> total) {
    std::vector<Complex> values(pictures / per_pixel * count);
    for (std::size_t pixel = 0; pixel < pictures / per_pixel; ++pixel)
      use(samples, total.subspan(pixel * per_pixel, per_pixel),
          std::span(values).subspan(pixel * count, count));
    return values;
  };
}

/// Returns the entries first .. first + count - 1 of all groups.
GroupedSums some_of(const GroupedSums& sums, std::size_t first, std::size_t count) {
  GroupedSums some(count);
  for (std::size_t group = 0; group < sums.groups(); ++group)
    some.add(sums.group_samples(group), sums.group_sums(group).subspan(first, count));
  return some;
}

/// Estimates the steady pictures.
Estimate steady_picture(const RenderJob& job, const GroupedSums& sums) {
  const std::size_t pixels = job.pixels(), first = job.first_steady();
  if (job.controls > 0)
    return job.estimate(
        steady_sums(job, sums),
        [=](double samples, std::span<const Complex> all) {
          return sample_mean(samples, all.subspan(first, pixels));
        },
        job.few_of_pictures(sums));
  return jackknife(sums, EntryRange{job.first_of_steady(), pixels}, job.few_of_pictures(sums));
}

/// Makes the estimator of the means of `count` sums of each pixel, beginning with sum `first`.
Estimator some_sums(const RenderJob& job, int first, int count) {
  return for_each_pixel(
      job.pictures, job.bins, static_cast<std::size_t>(count),
      [first](double samples, std::span<const Complex> own, std::span<Complex> to) {
        for (std::size_t i = 0; i < to.size(); ++i)
          to[i] = own[static_cast<std::size_t>(first) + i] / samples;
      });
}

std::string described_steps(const RenderScene& scene, const RenderPlan& plan) {
  std::ostringstream text;
  if (!plan.curved) return {};
  text << (scene.leapfrogs ? "; leapfrog steps of " : "; steps of ") << scene.step;
  if (scene.index) text << "; index " << scene.index->lowest << " to " << scene.index->highest;
  return text.str();
}

/// Describes the sensors; empty for a single one.
std::string described_sensors(const RenderScene& scene) {
  std::string text;
  if (scene.sensors.size() > 1)
    for (std::size_t i = 0; i < scene.sensors.size(); ++i)
      text += (i == 0 ? "; sensors " : ", ") + sensor_name(scene, i) + " (" +
              table_of(scene.sensors[i]).name + ')';
  return text;
}

std::string described_map(const RenderScene& scene) {
  return scene.map ? "; a map of " + std::to_string(cells(*scene.map)) + " cells" : "";
}

/// Whether a method traces light paths to their ends and tallies their power.
bool walks_light(RenderMethod method) {
  return method == RenderMethod::light || method == RenderMethod::bidirectional ||
         method == RenderMethod::forward;
}

/// Makes the tracer of a request. For a scene with a map but no sensor it uses light tracing.
Tracer tracer_of(const Tracers& tracers, const RenderScene& scene, const RenderRequest& request) {
  if (scene.sensors.empty()) return tracers.make(RenderMethod::light);
  return request.method ? tracers.make(*request.method) : best_tracer(tracers);
}

/// Whether all sensors have enough pixels for the neighbourhoods of bound_errors().
bool have_neighbours(const std::vector<SensorEnd>& sensors) {
  constexpr int many = 25;  // size of a neighbourhood in bound_errors()
  return std::ranges::all_of(
      sensors, [](const SensorEnd& sensor) { return sensor.pixels().count() >= many; });
}

/// Relative error of a picture; infinite if it is dark, since its error is then not known.
double error_of_light(const Estimate& light) {
  const bool is_lit = std::ranges::any_of(light.value, [](Complex x) { return x.real() > 0; });
  return is_lit ? relative_error(light) : std::numeric_limits<double>::infinity();
}

/// Returns the largest relative error of what the target of a run applies to, over the sensors,
/// whose units differ.
double largest_error(const RenderJob& job, const std::vector<LightCheck>& checks,
                     const std::vector<Sensor>& kinds, const std::optional<RenderTarget>& target,
                     const Estimate& picture, const GroupedSums& sums) {
  const auto target_of = [&](const Sensor& sensor) {
    return target.value_or(usual_target(sensor));
  };
  const bool are_pictures = std::ranges::all_of(
      kinds, [&](const Sensor& sensor) { return target_of(sensor) == RenderTarget::picture; });
  const GroupedSums steady = are_pictures ? GroupedSums() : steady_sums(job, sums);
  double largest = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const SensorPixels pixels = pixels_of(kinds[i]);
    const auto count = static_cast<std::size_t>(pixels.grid.count());
    const RenderTarget of = target_of(kinds[i]);
    if (of == RenderTarget::powers) {
      largest =
          std::max(largest, largest_error(*powers_within(kinds[i], checks[i], first, job, steady)));
    } else {
      Estimate own = of == RenderTarget::total ? sensor_mean(job, steady, checks[i], first, pixels)
                                               : part(picture, first, count);
      bound_errors(own, of == RenderTarget::total ? PixelGrid{} : pixels.grid);
      largest = std::max(largest, error_of_light(own));
    }
    first += count;
  }
  return largest;
}

/// Returns, for each pixel of all sensors, its sensor and its share of the sensor's area.
std::vector<PixelShare> pixel_shares(const std::vector<Sensor>& sensors) {
  std::vector<PixelShare> shares;
  for (std::size_t sensor = 0; sensor < sensors.size(); ++sensor) {
    const SensorPixels pixels = pixels_of(sensors[sensor]);
    for (int pixel = 0; pixel < pixels.grid.count(); ++pixel)
      shares.push_back({sensor, pixels.share(static_cast<std::size_t>(pixel))});
  }
  return shares;
}

/// Adds to `means` the means over the pixels of each sensor, computed by another tracer with a
/// quarter of the paths.
void add_means_by(const Tracer& tracer, int paths, const TimeBins& bins,
                  std::span<const PixelShare> shares, RandomStream random,
                  std::span<double> means) {
  const int few = std::max(1, paths / 4);
  std::vector<Complex> sums(shares.size() * static_cast<std::size_t>(bins.sums()));
  Film film(static_cast<int>(shares.size()), bins, sums);
  film.shares = shares;
  TransportCounts counts;
  tracer.add(few, random, film, counts);
  std::vector<double> own(means.size());
  film.add_means(own);
  for (std::size_t i = 0; i < means.size(); ++i) means[i] += own[i] * paths / few;
}

}  // namespace

GroupedSums steady_sums(const RenderJob& job, const GroupedSums& sums) {
  GroupedSums steady(job.first_steady() + job.pixels() + job.controls);
  std::vector<Complex> of_group;
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const auto all = sums.group_sums(group);
    of_group.clear();
    for (const auto part :
         {all.subspan(job.first_of_checks(), 2 * job.sensors),
          all.subspan(job.first_of_steady(), job.pixels()), all.last(job.controls)})
      of_group.insert(of_group.end(), part.begin(), part.end());
    steady.add(sums.group_samples(group), of_group);
  }
  return steady;
}

std::vector<LightCheck> light_checks(const RenderJob& job, const GroupedSums& sums) {
  constexpr double rounding = 1e-6;  // relative error due to rounding of the end points of flights
  constexpr double least_samples = 2000;  // with fewer samples rare paths are likely missing
  const bool is_enough = sums.groups() > 1 && sums.total_samples() >= least_samples;
  const double errors = is_enough ? std::max(5.0, outlier_errors(sums.groups())) : 0;
  const std::size_t count = job.sensors;
  const Estimate all = jackknife(
      some_of(sums, job.first_of_checks(), 2 * count),
      [&](double samples, std::span<const Complex> of) {
        auto values = sample_mean(samples, of);
        for (std::size_t i = 0; i < count; ++i) values.push_back(values[i] + values[count + i]);
        return values;
      },
      few_of_values);
  std::vector<LightCheck> checks(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t off = count + i, other = 2 * count + i;
    const double mean = all.value[i].real();
    LightCheck& check = checks[i];
    check = {{}, mean, all.value[other].real(), off};
    const bool is_known = is_enough && check.other > 0 && all.rare[other] == 0,
               is_undersampled = all.rare[i] != 0 && all.error[i] > mean / 2;
    if (is_known && !is_undersampled) {
      check.off = std::abs(all.value[off].real());
      check.limit = errors * all.error[off] + all.error[i] + rounding * check.other;
    }
    check.is_control = is_known && all.error[off] > rounding * mean && check.holds();
  }
  return checks;
}

std::optional<Invariant> worst_light(const std::vector<LightCheck>& checks) {
  std::optional<Invariant> worst;
  for (const LightCheck& each : checks)
    if (each.limit > 0 && (!worst || each.is_worse_than(*worst)))
      worst = Invariant{each.off / each.other, each.limit / each.other};
  return worst;
}

TransportCounts transport_counts(const RenderJob& job, const GroupedSums& sums) {
  return TransportCounts::of(some_of(sums, job.first_of_counts(), TransportCounts::size).total());
}

RenderTarget usual_target(const Sensor& sensor) {
  const auto* disks = std::get_if<RadialDetector>(&sensor);
  if (disks && !disks->radii.empty()) return RenderTarget::powers;
  return pixels_of(sensor).grid.count() > 1 ? RenderTarget::picture : RenderTarget::total;
}

Estimate sensor_mean(const RenderJob& job, const GroupedSums& steady, const LightCheck& check,
                     std::size_t first_pixel, const SensorPixels& pixels) {
  const auto mean = [&](double samples, std::span<const Complex> all) {
    const auto own = all.subspan(job.first_steady() + first_pixel);
    Complex sum = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(pixels.grid.count()); ++i)
      sum += pixels.share(i) * own[i];
    return std::vector{sum / samples};
  };
  return job.estimate_of(check, steady, mean);
}

std::string sensor_name(const RenderScene& scene, std::size_t sensor) {
  return scene.sensor_names.empty() ? std::to_string(sensor + 1) : scene.sensor_names[sensor];
}

std::string method_word(RenderMethod method) {
  return method_words().at(static_cast<std::size_t>(method));
}

std::vector<std::string> target_words() {
  return {"total", "powers", "picture"};
}

std::vector<std::string> method_words() {
  return {"path", "light", "bidirectional", "forward"};
}

namespace {

void check_forward(const RenderScene& scene) {
  if (!can_be_forward(scene))
    throw InputError("method", method_word(RenderMethod::forward),
                     "requires sensors that light can hit: no pinhole camera; set lens_radius, or "
                     "choose another method");
}

}  // namespace

void check(const RenderScene& scene, const RenderRequest& request) {
  check(scene.stage);
  if (scene.sensors.empty() && request.method.value_or(RenderMethod::light) != RenderMethod::light)
    throw InputError("method", method_word(*request.method),
                     "must be light or auto for a map without a sensor");
  const auto transport =
      transport_of(scene, request, request.method.value_or(RenderMethod::bidirectional));
  check_path_lengths(scene.stage, transport->max_scatterings);
  if (request.method == RenderMethod::forward) check_forward(scene);
  if (request.target == RenderTarget::powers &&
      !std::ranges::all_of(scene.sensors, [](const Sensor& sensor) {
        return usual_target(sensor) == RenderTarget::powers;
      }))
    throw InputError("target", "powers", "requires radii for every sensor");
  if (scene.bins.derivatives > 0 && request.method != RenderMethod::forward)
    throw InputError("gradient: requires method = forward");
  if (scene.bins.decay && request.method != RenderMethod::forward)
    throw InputError("delays: requires method = forward");
  if (scene.bins.sound && request.method != RenderMethod::forward)
    throw InputError("tag_wavelength: requires method = forward");
  if (!scene.parameters.empty() && request.method != RenderMethod::forward)
    throw InputError("gradient_by: requires method = forward");
  if (scene.random_phase) make_ray_field(scene.field)->frozen(0);
}

namespace {

/// Computes the sums of a batch.
struct RenderBatch {
  RenderJob job;  ///< layout of the accumulated sums of pictures and maps
  Tracer tracer;
  std::optional<Tracer> other;  ///< for the comparison of LightCheck
  MapKernel map;
  std::vector<PixelShare> shares;
  int paths;
  bool tallies_power;  ///< whether the tracer's light paths tally their power
  std::uint64_t seed;

  void operator()(std::uint64_t number, std::span<Complex> sums) const {
    Film film(static_cast<int>(shares.size()), job.bins, sums.first(job.pictures));
    film.shares = shares;
    film.hits.resize(other ? 0 : job.sensors);
    TransportCounts counts;
    EnergyBalance of_map;
    RandomStream random = stream(Stream::render, number);
    if (!shares.empty()) tracer.add(paths, random, film, counts);
    add_checks(film, number, sums.subspan(job.first_of_checks(), 2 * job.sensors));
    if (job.keeps_steady())
      for (std::size_t pixel = 0; pixel < shares.size(); ++pixel)
        sums[job.first_of_steady() + pixel] += film.steady(pixel);
    for (std::size_t i = 0; i < job.controls; ++i)
      sums[sums.size() - job.controls + i] += film.control_variates[i];
    if (map) {
      RandomStream own = stream(Stream::light_map, number);
      map(paths, own, sums.subspan(job.first_of_map()), of_map, counts);
    }
    if (job.has_energy)
      (tallies_power ? film.energy : of_map)
          .add_to(sums.subspan(job.pictures, EnergyBalance::size));
    counts.add_to(sums.subspan(job.first_of_counts(), TransportCounts::size));
  }

 private:
  RandomStream stream(Stream of, std::uint64_t number) const {
    return {seed, static_cast<std::uint64_t>(of), number};
  }
  void add_checks(Film& film, std::uint64_t number, std::span<Complex> sums) const {
    // batch numbers from here on have separate random streams
    constexpr std::uint64_t others = std::uint64_t{1} << 62;
    std::vector<double> means(job.sensors);
    film.add_means(means);
    if (other) {
      film.hits.resize(job.sensors);
      add_means_by(*other, paths, job.bins, shares, stream(Stream::render, others + number),
                   film.hits);
    }
    for (std::size_t i = 0; i < job.sensors; ++i) {
      sums[i] += means[i];
      sums[job.sensors + i] += film.hits[i] - means[i];
    }
  }
};

}  // namespace

RenderJob render_job(const RenderScene& scene, const RenderRequest& request, std::uint64_t seed) {
  check(scene, request);
  const Tracers tracers(scene, request);
  const Tracer tracer = tracer_of(tracers, scene, request);
  const MapKernel map = tracers.map_kernel();

  RenderJob job;
  const int pixels = tracer.transport->pixels();
  job.bins = scene.bins;
  job.plan = described(scene, request, tracer.method) + tracers.plan().describe() +
             described_steps(scene, tracers.plan()) + described_sensors(scene) +
             described_map(scene) + (tracers.walks() ? "" : "; rays of beams alone") +
             (tracer.is_guided ? "; paths guided to the sensors" : "") +
             (tracer.is_guided && !scene.bins.sound ? " and turned about the light" : "") +
             (tracer.is_aimed ? "; lights aimed at the sensors" : "");
  job.pictures = static_cast<std::size_t>(pixels) * scene.bins.sums();
  const bool tallies_power = walks_light(tracer.method) && pixels > 0;
  job.has_energy = tallies_power || map;
  if (tracer.has_control_variates) job.controls = control_variate_count;
  job.sensors = scene.sensors.size();
  job.batches.size = job.first_of_map() + (map ? map_sums(*scene.map, scene.stage) : 0) +
                     (job.keeps_steady() ? job.pixels() : 0) + job.controls;
  const int least =
      paths_per_batch(tracer, tracers.plan().scatters, tracers.cost_of_flight(), job.batches.size);
  const int paths =
      tracer.method == RenderMethod::forward ? least : paths_of_whole_pictures(tracer, least);
  job.batches.samples_per_batch = paths;
  constexpr std::uint64_t fewest_batches = 32;
  job.batches.trusted_batches =
      std::max(trusted_batches * static_cast<std::uint64_t>(least) / paths, fewest_batches);
  job.batches.deterministic = !tracers.plan().scatters;
  if (tracer.method == RenderMethod::forward)
    job.batches.trusted_batches = 64;  // no path has a high weight
  RenderBatch batch{job, tracer, {}, map, pixel_shares(scene.sensors), paths, tallies_power, seed};
  if (tracer.method == RenderMethod::path) batch.other = tracers.make(RenderMethod::bidirectional);
  job.batches.run = batch;
  job.pixels_have_neighbours = have_neighbours(tracer.transport->sensors);
  job.batches.relative_error = [layout = job, kinds = scene.sensors, cells = scene.map,
                                target = request.target](const GroupedSums& sums) {
    const std::vector<LightCheck> checks = light_checks(layout, sums);
    if (!std::ranges::all_of(checks, &LightCheck::holds))
      return std::numeric_limits<double>::infinity();
    const double of_pictures =
        largest_error(layout, checks, kinds, target, steady_picture(layout, sums), sums);
    return cells
               ? std::max(of_pictures, error_of_light(fluence(sums, layout.first_of_map(), *cells)))
               : of_pictures;
  };
  return job;
}

namespace {

/// Returns the indices of the last `count` of all sums.
std::vector<std::size_t> last_of(const GroupedSums& sums, std::size_t count) {
  std::vector<std::size_t> last(count);
  std::iota(last.begin(), last.end(), sums.size() - count);
  return last;
}

}  // namespace

Estimate RenderJob::estimate(const GroupedSums& sums, const Estimator& theta, double few) const {
  return controls > 0 ? controlled_jackknife(sums, theta, last_of(sums, controls), few)
                      : jackknife(sums, theta, few);
}

Estimate RenderJob::estimate_of(const LightCheck& check, const GroupedSums& steady,
                                const Estimator& theta) const {
  if (!check.is_control) return estimate(steady, theta);
  std::vector<std::size_t> all = last_of(steady, controls);
  all.push_back(check.difference);
  return controlled_jackknife(steady, theta, all, few_of_values);
}

RenderedPicture rendered_picture(const RenderJob& job, const GroupedSums& sums) {
  const TimeBins& bins = job.bins;
  const auto estimate = [&](const Estimator& theta) {
    return job.estimate(sums, theta, job.few_of_pictures(sums));
  };
  RenderedPicture picture{.bins = estimate(some_sums(job, bins.count > 1 ? 1 : 0, bins.count)),
                          .steady = steady_picture(job, sums)};
  if (bins.count == 1) return picture;
  picture.before = estimate(some_sums(job, 0, 1));
  picture.after = estimate(some_sums(job, bins.count + 1, 1));
  return picture;
}

}  // namespace flatspeckle::grin

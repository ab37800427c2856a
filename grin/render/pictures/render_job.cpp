#include "grin/render/pictures/render_job.h"

#include <algorithm>
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

/// Sums over an entry and its neighbours along one axis.
std::vector<double> sums_along(const std::vector<double>& values, std::size_t stride,
                               std::size_t length) {
  constexpr std::size_t reach = 2;
  std::vector<double> sums(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t place = i / stride % length;
    const std::size_t from = i - std::min(place, reach) * stride;
    const std::size_t to = i + std::min(length - 1 - place, reach) * stride;
    for (std::size_t k = from; k <= to; k += stride) sums[i] += values[k];
  }
  return sums;
}

std::vector<double> sums_around(const std::vector<double>& values, const PixelGrid& grid) {
  const auto rows = static_cast<std::size_t>(grid.rows);
  const auto columns = static_cast<std::size_t>(grid.columns);
  const std::size_t bins = values.size() / (rows * columns);
  return sums_along(sums_along(sums_along(values, 1, bins), bins, columns), bins * columns, rows);
}

/// Contributions of a size c make a variance of c times their sum. Where 3 c were to come nothing
/// comes one time of 20: that is two errors of 1.5 c.
double unseen(double variance, double sum) {
  return sum > 0 ? 1.5 * variance / sum : 0;
}

/// So many that adding up the picture takes little of the time, and so few that a batch ends soon
/// and the number of batches from which errors are trusted is soon there: long paths are fewer.
/// A power of two: no rounding of the flights changes it.
int paths_per_batch(const Tracer& tracer, bool scatters, double cost_of_flight, std::size_t sums) {
  constexpr double most = 16384, flights_soon_made = 1024;
  const double fewest = std::clamp(flights_soon_made / tracer.flights_per_pair, 1.0, 32.0);
  constexpr double most_flights = 1 << 17;
  const double paths = std::clamp(static_cast<double>(sums) / (16 * cost_of_flight), fewest, most);
  const auto short_enough =
      static_cast<std::size_t>(std::min(paths, most_flights / tracer.flights_per_pair));
  const bool fills_lanes = tracer.method == RenderMethod::analog && scatters;
  const double many = fills_lanes ? 4 * lanes / tracer.flights_per_pair : 1;
  return static_cast<int>(
      std::max(std::bit_floor(short_enough), std::bit_ceil(static_cast<std::size_t>(many))));
}

std::string described(const RenderScene& scene, const RenderRequest& request, RenderMethod method) {
  std::string text = method_word(method);
  if (!request.method && !scene.sensors.empty()) text += " (chosen by a pilot)";
  if (!has_finite_variance(scene, method))
    text += " (no finite variance with " +
            std::string(method == RenderMethod::path ? "points, fibres or beams that are bent"
                                                     : "a pinhole") +
            ": errors are not to be trusted)";
  return text + ": ";
}

/// From [pixel][sum] `count` values for each pixel: use(sums of the pixel, its values).
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

Estimator steady_picture(std::size_t pictures, const TimeBins& bins) {
  return for_each_pixel(pictures, bins, 1,
                        [parts = static_cast<std::size_t>(bins.parts())](
                            double samples, std::span<const Complex> own, std::span<Complex> to) {
                          for (const Complex part : own.first(parts)) to[0] += part / samples;
                        });
}

/// `count` of the sums of each pixel.
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

/// Nothing of a single one.
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

/// To their ends, booking where their power went.
bool walks_light(RenderMethod method) {
  return method == RenderMethod::light || method == RenderMethod::bidirectional ||
         method == RenderMethod::analog;
}

/// A map alone asks for no picture.
Tracer tracer_of(const Tracers& tracers, const RenderScene& scene, const RenderRequest& request) {
  if (scene.sensors.empty()) return tracers.make(RenderMethod::light);
  return request.method ? tracers.make(*request.method) : best_tracer(tracers);
}

/// Groups, where pixels have neighbours to be judged with.
double few_of(const std::vector<SensorEnd>& sensors) {
  constexpr int many = 25;  // as bound_errors() looks at
  const bool have_neighbours = std::ranges::all_of(
      sensors, [](const SensorEnd& sensor) { return sensor.pixels().count() >= many; });
  return have_neighbours ? few_of_pixels : few_of_values;
}

using Estimating = std::function<Estimate(const GroupedSums&, const Estimator&)>;

/// Infinite in the dark, which is no knowledge of it.
double error_of_light(const Estimate& light) {
  const bool is_lit = std::ranges::any_of(light.value, [](Complex x) { return x.real() > 0; });
  return is_lit ? relative_error(light) : std::numeric_limits<double>::infinity();
}

/// That of the sensor where it is largest: units of sensors differ.
double largest_error(const Transport& transport, const std::vector<Sensor>& kinds,
                     const TimeBins& bins, const Estimate& picture, const GroupedSums& sums,
                     const Estimating& estimate) {
  double largest = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const PixelGrid pixels = transport.sensors[i].pixels();
    const auto count = static_cast<std::size_t>(pixels.count());
    if (const auto powers = powers_within(kinds[i], first, bins, sums, estimate)) {
      largest = std::max(largest, largest_error(*powers, transport.lights.power()));
    } else {
      Estimate own = part(picture, first, count);
      bound_errors(own, pixels);
      largest = std::max(largest, error_of_light(own));
    }
    first += count;
  }
  return largest;
}

/// Of all pixels of all sensors.
std::vector<PixelShare> pixel_shares(const std::vector<Sensor>& sensors) {
  std::vector<PixelShare> shares;
  for (std::size_t sensor = 0; sensor < sensors.size(); ++sensor) {
    const SensorPixels pixels = pixels_of(sensors[sensor]);
    for (int pixel = 0; pixel < pixels.grid.count(); ++pixel)
      shares.push_back({sensor, pixels.share(static_cast<std::size_t>(pixel))});
  }
  return shares;
}

/// Adds means over the pixels of each sensor by another tracer, which draws a quarter of the paths.
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

std::vector<LightCheck> light_checks(const RenderJob& job, const GroupedSums& sums) {
  constexpr double rounding = 1e-6;       // of ends of flights
  constexpr double least_samples = 2000;  // fewer know nothing of rare paths
  const bool is_enough = sums.groups() > 1 && sums.total_samples() >= least_samples;
  const double errors = is_enough ? std::max(5.0, outlier_errors(sums.groups())) : 0;
  const std::size_t count = job.sensors;
  const Estimate all = jackknife(
      sums,
      [&](double samples, std::span<const Complex> of) {
        auto values = sample_mean(samples, of.subspan(job.first_of_checks(), 2 * count));
        for (std::size_t i = 0; i < count; ++i) values.push_back(values[i] - values[count + i]);
        return values;
      },
      few_of_values);
  std::vector<LightCheck> checks(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double mean = all.value[i].real(), other = all.value[count + i].real();
    const bool is_known = is_enough && other > 0 && all.rare[count + i] == 0,
               is_marked = all.rare[i] != 0 && all.error[i] > mean / 2;
    if (is_known && !is_marked)
      checks[i] = {{std::abs(all.value[2 * count + i].real()),
                    errors * all.error[2 * count + i] + all.error[i] + rounding * other},
                   mean,
                   other};
  }
  return checks;
}

std::optional<Invariant> worst_light(const std::vector<LightCheck>& checks) {
  std::optional<Invariant> worst;
  for (const LightCheck& each : checks)
    if (each.other > 0 && (!worst || each.is_worse_than(*worst)))
      worst = Invariant{each.off / each.other, each.limit / each.other};
  return worst;
}

TransportCounts transport_counts(const RenderJob& job, const GroupedSums& sums) {
  const std::vector<Complex> all = sums.total();
  return TransportCounts::of(std::span(all).subspan(job.first_of_counts(), TransportCounts::size));
}

void bound_errors(Estimate& picture, const PixelGrid& grid) {
  const std::size_t size = picture.value.size();
  const std::vector<double> values = real_parts(picture.value);
  std::vector<double> variances(size), marked(size), marks(size), lit(size);
  for (std::size_t i = 0; i < size; ++i) {
    variances[i] = picture.error[i] * picture.error[i];
    marked[i] = picture.rare[i] ? values[i] : 0;
    lit[i] = values[i] != 0;
    marks[i] = picture.rare[i] ? lit[i] : 0;
  }
  const double of_all = unseen(std::reduce(variances.begin(), variances.end()),
                               std::reduce(values.begin(), values.end()));
  if (!std::isfinite(of_all)) return;  // a single batch
  const auto values_around = sums_around(values, grid);
  const auto variances_around = sums_around(variances, grid);
  const auto marked_around = sums_around(marked, grid);
  const auto marks_around = sums_around(marks, grid), lit_around = sums_around(lit, grid);
  for (std::size_t i = 0; i < size; ++i) {
    const bool is_known = values[i] != 0 && marked_around[i] <= values_around[i] / 2 &&
                          marks_around[i] <= lit_around[i] / 2;
    picture.rare[i] = !is_known;
    if (is_known) continue;
    const double bound =
        values_around[i] > 0 ? unseen(variances_around[i], values_around[i]) : of_all;
    picture.error[i] = std::max(2 * picture.error[i], bound);
  }
}

std::string sensor_name(const RenderScene& scene, std::size_t sensor) {
  return scene.sensor_names.empty() ? std::to_string(sensor + 1) : scene.sensor_names[sensor];
}

std::string method_word(RenderMethod method) {
  return method_words().at(static_cast<std::size_t>(method));
}

std::vector<std::string> method_words() {
  return {"path", "light", "bidirectional", "analog"};
}

namespace {

void check_analog(const RenderScene& scene) {
  if (!can_be_analog(scene))
    throw InputError("method", method_word(RenderMethod::analog),
                     "is of sensors that light can hit");
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
  if (request.method == RenderMethod::analog) check_analog(scene);
  if (scene.bins.derivatives > 0 && request.method != RenderMethod::analog)
    throw InputError("gradient: needs method = analog");
  if (!scene.parameters.empty() && request.method != RenderMethod::analog)
    throw InputError("gradient_by: needs method = analog");
  if (scene.random_phase) make_ray_field(scene.field)->frozen(0);
}

namespace {

/// Adds a batch to its sums.
struct RenderBatch {
  RenderJob job;  ///< what the sums are
  Tracer tracer;
  std::optional<Tracer> other;  ///< to compare with
  MapKernel map;
  std::vector<PixelShare> shares;
  int paths;
  bool books;  ///< where the power of the tracer's light paths goes
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
    if (job.has_drift) sums.back() += film.drift;
    if (map) {
      RandomStream own = stream(Stream::light_map, number);
      map(paths, own, sums.subspan(job.first_of_map()), of_map, counts);
    }
    if (job.has_energy)
      (books ? film.energy : of_map).add_to(sums.subspan(job.pictures, EnergyBalance::size));
    counts.add_to(sums.subspan(job.first_of_counts(), TransportCounts::size));
  }

 private:
  RandomStream stream(Stream of, std::uint64_t number) const {
    return {seed, static_cast<std::uint64_t>(of), number};
  }
  void add_checks(Film& film, std::uint64_t number, std::span<Complex> sums) const {
    constexpr std::uint64_t others = std::uint64_t{1} << 62;  // batches of numbers of their own
    std::vector<double> means(job.sensors);
    film.add_means(means);
    if (other) {
      film.hits.resize(job.sensors);
      add_means_by(*other, paths, job.bins, shares, stream(Stream::render, others + number),
                   film.hits);
    }
    for (std::size_t i = 0; i < job.sensors; ++i) {
      sums[i] += means[i];
      sums[job.sensors + i] += film.hits[i];
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
             described_map(scene) + (tracers.walks() ? "" : "; rays of beams alone");
  job.pictures = static_cast<std::size_t>(pixels) * scene.bins.sums();
  const bool books = walks_light(tracer.method) && pixels > 0;
  job.has_energy = books || map;
  job.has_drift = books && tracers.has_drift();
  job.sensors = scene.sensors.size();
  job.batches.size =
      job.first_of_map() + (map ? sums_per_cell * cells(*scene.map) : 0) + (job.has_drift ? 1 : 0);
  const int paths =
      paths_per_batch(tracer, tracers.plan().scatters, tracers.cost_of_flight(), job.batches.size);
  job.batches.samples_per_batch = paths;
  job.batches.deterministic = !tracers.plan().scatters;
  if (tracer.method == RenderMethod::analog) job.batches.trusted_batches = 64;  // no path is strong
  RenderBatch batch{job, tracer, {}, map, pixel_shares(scene.sensors), paths, books, seed};
  if (tracer.method == RenderMethod::path) batch.other = tracers.make(RenderMethod::bidirectional);
  job.batches.run = batch;
  job.few_of_pictures = few_of(tracer.transport->sensors);
  const EntrySums steady_sums{static_cast<std::size_t>(pixels),
                              static_cast<std::size_t>(scene.bins.sums()),
                              static_cast<std::size_t>(scene.bins.parts())};
  job.batches.relative_error = [=, checked = job, kinds = scene.sensors, bins = scene.bins,
                                cells = scene.map,
                                steady = steady_picture(job.pictures, scene.bins),
                                has_drift = job.has_drift, few = job.few_of_pictures,
                                first_of_map = job.first_of_map()](const GroupedSums& sums) {
    if (!std::ranges::all_of(light_checks(checked, sums), &LightCheck::holds))
      return std::numeric_limits<double>::infinity();
    const Estimate picture = has_drift ? controlled_jackknife(sums, steady, sums.size() - 1, few)
                                       : jackknife(sums, steady_sums, few);
    const auto estimate = [&](const GroupedSums& of, const Estimator& theta) {
      return has_drift ? controlled_jackknife(of, theta, of.size() - 1, few_of_values)
                       : jackknife(of, theta, few_of_values);
    };
    const double of_pictures =
        largest_error(*tracer.transport, kinds, bins, picture, sums, estimate);
    return cells ? std::max(of_pictures, error_of_light(fluence(sums, first_of_map, *cells)))
                 : of_pictures;
  };
  return job;
}

Estimate RenderJob::estimate(const GroupedSums& sums, const Estimator& theta, double few) const {
  return has_drift ? controlled_jackknife(sums, theta, sums.size() - 1, few)
                   : jackknife(sums, theta, few);
}

RenderedPicture rendered_picture(const RenderJob& job, const GroupedSums& sums) {
  const TimeBins& bins = job.bins;
  const auto estimate = [&](const Estimator& theta) {
    return job.estimate(sums, theta, job.few_of_pictures);
  };
  RenderedPicture picture{.bins = estimate(some_sums(job, bins.count > 1 ? 1 : 0, bins.count)),
                          .steady = estimate(steady_picture(job.pictures, bins))};
  if (bins.count == 1) return picture;
  picture.before = estimate(some_sums(job, 0, 1));
  picture.after = estimate(some_sums(job, bins.count + 1, 1));
  return picture;
}

}  // namespace flatspeckle::grin

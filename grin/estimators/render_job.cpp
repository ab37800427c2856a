#include "grin/estimators/render_job.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>

#include "core/numbers/random.h"
#include "grin/estimators/path_kernels.h"
#include "grin/estimators/photon_map.h"
#include "grin/estimators/render_pilot.h"
#include "grin/estimators/unscattered_beams.h"
#include "grin/space/curved_space.h"

namespace flatspeckle::grin {

namespace {

/// What a join costs, in flights; less than that, as a level too low only costs time.
constexpr double flights_per_curve = 4, flights_per_line = 0.1;

Strategies strategies(RenderMethod method) {
  return {.short_light = method == RenderMethod::path,
          .short_sensor = method == RenderMethod::light};
}

bool is_photon_map(const RenderRequest& request) {
  return request.method == RenderMethod::photon_map;
}

constexpr int unlimited = std::numeric_limits<int>::max();

int path_limit(const RenderRequest& request) {
  if (request.max_scatterings <= 0) return unlimited;
  return static_cast<int>(std::min<std::int64_t>(request.max_scatterings, unlimited));
}

double photon_radius(const RenderScene& scene, const RenderRequest& request) {
  return request.photon_radius > 0 ? request.photon_radius : default_photon_radius(scene.stage);
}

/// Lights, sensor and kernels of a scene.
struct Tracer {
  std::shared_ptr<Transport> transport;
  PathKernel kernel;
  PathKernel unscattered_beams = {};  ///< where the kernel leaves that out and there is some
};

bool sums_beams_apart(const Transport& transport, const RenderRequest& request) {
  return !is_photon_map(request) && transport.lights.beam_power() > 0 &&
         std::any_of(transport.sensors.begin(), transport.sensors.end(),
                     [](const SensorEnd& sensor) { return sensor.can_be_hit(); });
}

double index_at(const RenderScene& scene, const PathPoint& p) {
  if (scene.stage.body && p.part == Part::stage) return 1 + scene.stage.excess_around;
  return std::visit([&](const auto& field) { return index(field, p.x); }, scene.field);
}

std::shared_ptr<Transport> transport_in(const RenderScene& scene, const RenderRequest& request) {
  const auto index = [&](const PathPoint& p) { return index_at(scene, p); };
  return std::make_shared<Transport>(Transport{
      .stage = scene.stage,
      .lights = Lights(scene.lights, scene.stage, index),
      .sensors = sensor_ends(scene.sensors, scene.stage),
      .strategies = strategies(request.method),
      .max_scatterings = path_limit(request),
  });
}

Tracer straight_tracer(const RenderScene& scene, const RenderRequest& request,
                       const RenderPlan& plan) {
  const double excess = std::get<Homogeneous>(scene.field).n_excess;
  const auto transport = transport_in(scene, request);
  Tracer tracer{transport, is_photon_map(request) ? photon_kernel(plan.timed, transport, excess,
                                                                  photon_radius(scene, request))
                                                  : straight_kernel(plan, transport, excess)};
  if (sums_beams_apart(*transport, request))
    tracer.unscattered_beams = beams_kernel(plan.timed, transport, excess);
  return tracer;
}

Tracer curved_tracer(const RenderScene& scene, const RenderRequest& request,
                     const RenderPlan& plan) {
  const std::shared_ptr<const CurvedSpace> space = make_curved_space(
      scene.field, scene.stage, {scene.step, scene.max_length, !is_photon_map(request)});
  const auto transport = transport_in(scene, request);
  if (is_photon_map(request))
    return {transport, photon_kernel(plan.timed, transport, space, scene.random_phase,
                                     photon_radius(scene, request))};
  Tracer tracer{transport, curved_kernel(plan, transport, space, scene.random_phase)};
  if (sums_beams_apart(*transport, request))
    tracer.unscattered_beams =
        beams_kernel(plan.timed, transport,
                     make_curved_space(scene.field, without_scattering(scene.stage),
                                       {scene.step, scene.max_length, false}),
                     scene.random_phase);
  return tracer;
}

/// Of a picture's size, and so few that a batch ends soon where paths are long. A power of two: no
/// rounding of the flights changes it.
int paths_per_batch(const RenderRequest& request, std::size_t sums, double flights_per_pair) {
  const double most_flights = is_photon_map(request) ? 1 << 20 : 1 << 17;
  const std::size_t paths = is_photon_map(request) ? photon_paths_per_batch
                                                   : std::clamp<std::size_t>(sums / 8, 32, 16384);
  const auto short_enough = static_cast<std::size_t>(most_flights / flights_per_pair);
  return static_cast<int>(std::min(paths, std::bit_floor(std::max<std::size_t>(short_enough, 1))));
}

std::vector<Complex> steady_mean(double samples, std::span<const Complex> sums, int bins) {
  std::vector<Complex> steady(sums.size() / bins);
  for (std::size_t i = 0; i < sums.size(); ++i) steady[i / bins] += sums[i] / samples;
  return steady;
}

Estimate steady_picture(const GroupedSums& sums, int bins) {
  return jackknife(sums, [bins](double samples, std::span<const Complex> total) {
    return steady_mean(samples, total, bins);
  });
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

/// That of the sensor where it is largest: units of sensors differ.
double largest_error(const std::vector<SensorEnd>& sensors, const Estimate& picture) {
  double largest = 0;
  std::size_t first = 0;
  for (const SensorEnd& sensor : sensors) {
    const auto count = static_cast<std::size_t>(sensor.pixels().count());
    largest = std::max(largest, relative_error(part(picture, first, count)));
    first += count;
  }
  return largest;
}

}  // namespace

std::string sensor_name(const RenderScene& scene, std::size_t sensor) {
  return scene.sensor_names.empty() ? std::to_string(sensor + 1) : scene.sensor_names[sensor];
}

RenderPlan render_plan(const RenderScene& scene) {
  RenderPlan plan;
  plan.curved = !std::holds_alternative<Homogeneous>(scene.field);
  plan.body = scene.stage.body.has_value();
  plan.timed = scene.bins.count > 1;
  plan.scatters = plan.absorbs = plan.gridded = false;
  const auto add = [&](const ScatteringMedium& medium) {
    plan.scatters |= medium.mu_s > 0;
    plan.absorbs |= medium.mu_a > 0;
    plan.gridded |= medium.density && medium.mu_t() > 0;
  };
  add(scene.stage.medium);
  if (scene.stage.body) add(scene.stage.body->medium);
  return plan;
}

void check(const RenderScene& scene, const RenderRequest& request) {
  check(scene.stage);
  check_path_lengths(scene.stage, path_limit(request));
  if (scene.random_phase) make_ray_field(scene.field)->frozen(0);
  transport_in(scene, request);
}

RenderJob render_job(const RenderScene& scene, const RenderRequest& request, std::uint64_t seed) {
  check(scene, request);
  const RenderPlan plan = render_plan(scene);
  const Tracer tracer =
      plan.curved ? curved_tracer(scene, request, plan) : straight_tracer(scene, request, plan);
  const double flights = is_photon_map(request)
                             ? flights_per_pair(*tracer.transport, tracer.kernel, scene.bins)
                             : tune_joins(*tracer.transport, tracer.kernel, scene.bins,
                                          plan.curved ? flights_per_curve : flights_per_line);

  RenderJob job;
  const int pixels = tracer.transport->pixels();
  job.bins = scene.bins;
  job.plan = plan.describe() + described_sensors(scene);
  job.batches.size = static_cast<std::size_t>(pixels) * scene.bins.count;
  const int paths = paths_per_batch(request, job.batches.size, flights);
  job.batches.samples_per_batch = paths;
  const auto counts = std::make_shared<TransportCounts>();
  job.counts = counts;
  const auto counting = std::make_shared<std::mutex>();
  job.batches.run = [=, bins = scene.bins](std::uint64_t number, std::span<Complex> sums) {
    Film film(pixels, bins, sums);
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::render), number);
    TransportCounts of_batch;
    tracer.kernel(paths, random, film, of_batch, nullptr);
    if (tracer.unscattered_beams) tracer.unscattered_beams(paths, random, film, of_batch, nullptr);
    const std::lock_guard lock(*counting);
    *counts += of_batch;
  };
  job.batches.relative_error = [=, bins = scene.bins.count](const GroupedSums& sums) {
    return largest_error(tracer.transport->sensors, steady_picture(sums, bins));
  };
  return job;
}

RenderedPicture rendered_picture(const RenderJob& job, const GroupedSums& sums) {
  return {jackknife(sums, sample_mean), steady_picture(sums, job.bins.count)};
}

}  // namespace flatspeckle::grin

#include "grin/estimators/method_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace flatspeckle::grin {

namespace {

constexpr int groups = 32;

/// Of one sensor's picture, by a group of paths.
struct PictureMoments {
  double total = 0, variance = 0;  ///< mean of the sum over the pixels; sum of the variances
};
struct Trial {
  std::vector<PictureMoments> pictures;  ///< by sensor
  double work = 0;
};

/// What costs time, in flights of cost 1.
double work(const TransportCounts& counts, const Tracers& tracers) {
  const bool curved = tracers.plan().curved;
  const double per_promise = curved ? 0.03 : 0.3, per_iteration = curved ? 2 : 1;
  const double steps = static_cast<double>(counts.flights) +
                       per_iteration * static_cast<double>(counts.connections.iterations);
  return tracers.cost_of_flight() * steps +
         per_promise * static_cast<double>(counts.joins_weighed) +
         0.1 * static_cast<double>(counts.joins);
}

std::vector<PictureMoments> moments(const Transport& transport, std::span<const double> sums,
                                    std::span<const double> squares) {
  std::vector<PictureMoments> found;
  std::size_t pixel = 0;
  for (const SensorEnd& sensor : transport.sensors) {
    PictureMoments& picture = found.emplace_back();
    for (const std::size_t end = pixel + static_cast<std::size_t>(sensor.pixels().count());
         pixel < end; ++pixel) {
      const double mean = sums[pixel] / groups;
      picture.total += mean;
      picture.variance += squares[pixel] / groups - mean * mean;
    }
  }
  return found;
}

/// Nothing where the work is beyond all measure.
std::optional<Trial> tried(const Tracers& tracers, const Tracer& tracer, int pairs_per_group,
                           double most_work) {
  constexpr auto no_batch = std::numeric_limits<std::uint64_t>::max() - 1;
  const TimeBins& bins = tracers.scene().bins;
  const auto pixels = static_cast<std::size_t>(tracer.transport->pixels());
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), no_batch);
  TransportCounts counts;
  std::vector<double> sums(pixels), squares(pixels);
  for (int group = 0; group < groups; ++group) {
    std::vector<Complex> values(pixels * static_cast<std::size_t>(bins.sums()));
    Film film(static_cast<int>(pixels), bins, values);
    tracer.add(pairs_per_group, random, film, counts);
    if (work(counts, tracers) > most_work) return std::nullopt;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      double value = 0;
      for (int part = 0; part < bins.parts(); ++part)
        value += values[pixel * static_cast<std::size_t>(bins.sums()) + part].real();
      value /= pairs_per_group;
      sums[pixel] += value;
      squares[pixel] += value * value;
    }
  }
  return Trial{moments(*tracer.transport, sums, squares), work(counts, tracers)};
}

/// A few pairs of paths, then as many as the work allows.
std::optional<Trial> tried(const Tracers& tracers, const Tracer& tracer) {
  const double enough = tracers.plan().curved ? 1 << 15 : 1 << 17;
  if (!(tracer.flights_per_pair * tracers.cost_of_flight() * groups < enough)) return std::nullopt;
  const auto few = tried(tracers, tracer, 1, enough);
  if (!few) return few;
  const auto pairs = static_cast<int>(enough / few->work);
  return pairs > 1 ? tried(tracers, tracer, pairs, 8 * enough) : few;
}

/// Work to a given error, of the sensor for which it is most; the light that a picture has is taken
/// from `reference`. Infinite where light was missed.
double work_to_error(const Trial& trial, const Trial& reference) {
  double most = 0;
  for (std::size_t i = 0; i < trial.pictures.size(); ++i) {
    const double light = reference.pictures[i].total;
    if (!(light > 0)) continue;
    if (!(trial.pictures[i].total > light / 2)) return std::numeric_limits<double>::infinity();
    most = std::max(most, trial.pictures[i].variance / (light * light));
  }
  return most * trial.work;
}

bool is_pinhole(const Sensor& sensor) {
  const auto* camera = std::get_if<Camera>(&sensor);
  return camera && camera->lens_radius == 0;
}

}  // namespace

bool has_finite_variance(const RenderScene& scene, RenderMethod method) {
  if (!render_plan(scene).scatters) return true;
  if (method == RenderMethod::path)
    return std::none_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
      return !std::holds_alternative<FaceLight>(light);
    });
  return method != RenderMethod::light ||
         std::none_of(scene.sensors.begin(), scene.sensors.end(), is_pinhole);
}

Tracer best_tracer(const Tracers& tracers) {
  constexpr double clearly = 0.8;  // bidirectional misses least where the trial is too short
  Tracer best = tracers.make(RenderMethod::bidirectional);
  const auto reference = tried(tracers, best);
  if (!reference) return best;
  double least = clearly * work_to_error(*reference, *reference);
  for (const RenderMethod method : {RenderMethod::path, RenderMethod::light}) {
    if (!has_finite_variance(tracers.scene(), method)) continue;
    Tracer tracer = tracers.make(method);
    const auto trial = tried(tracers, tracer);
    const double needed =
        trial ? work_to_error(*trial, *reference) : std::numeric_limits<double>::infinity();
    if (!(needed < least)) continue;
    least = needed;
    best = std::move(tracer);
  }
  return best;
}

}  // namespace flatspeckle::grin

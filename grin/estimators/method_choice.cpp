#include "grin/estimators/method_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace flatspeckle::grin {

namespace {

constexpr int groups = 32;

/// Of one sensor's picture, by a group of paths.
struct PictureMoments {
  double total = 0, variance = 0;  ///< mean of the sum over the pixels; sum of the variances
  double lit = 0;                  ///< how many groups have the light, at equal shares
};
struct Trial {
  std::vector<PictureMoments> pictures;  ///< by sensor
  double work = 0;
};

/// What costs time, in flights of cost 1.
double work(const TransportCounts& counts, const Tracers& tracers, RenderMethod method) {
  const bool curved = tracers.plan().curved;
  const double per_flight = curved && method == RenderMethod::light ? 0.7 : 1;  // most without |J|
  const double per_promise = curved ? 0.03 : 0.3, per_iteration = curved ? 2 : 1;
  const double steps = per_flight * static_cast<double>(counts.flights) +
                       per_iteration * static_cast<double>(counts.connections.iterations);
  return tracers.cost_of_flight() * steps +
         per_promise * static_cast<double>(counts.joins_weighed) +
         0.1 * static_cast<double>(counts.joins);
}

/// Of the groups of one sensor's picture.
class PictureSums {
 public:
  explicit PictureSums(const SensorEnd& sensor)
      : sums_(static_cast<std::size_t>(sensor.pixels().count())), squares_(sums_.size()) {}

  std::size_t pixels() const { return sums_.size(); }
  void add(std::span<const double> group) {
    for (std::size_t pixel = 0; pixel < group.size(); ++pixel) {
      sums_[pixel] += group[pixel];
      squares_[pixel] += group[pixel] * group[pixel];
    }
    const double light = std::reduce(group.begin(), group.end());
    light_ += light;
    light_square_ += light * light;
  }
  PictureMoments moments() const {
    PictureMoments picture{.total = light_ / groups,
                           .lit = light_ > 0 ? light_ * light_ / light_square_ : 0};
    for (std::size_t pixel = 0; pixel < sums_.size(); ++pixel) {
      const double mean = sums_[pixel] / groups;
      picture.variance += squares_[pixel] / groups - mean * mean;
    }
    return picture;
  }

 private:
  std::vector<double> sums_, squares_;
  double light_ = 0, light_square_ = 0;
};

/// Nothing where the work is beyond all measure.
std::optional<Trial> tried(const Tracers& tracers, const Tracer& tracer, int pairs_per_group,
                           double most_work) {
  constexpr auto no_batch = std::numeric_limits<std::uint64_t>::max() - 1;
  const TimeBins& bins = tracers.scene().bins;
  const auto pixels = static_cast<std::size_t>(tracer.transport->pixels());
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), no_batch);
  TransportCounts counts;
  std::vector<PictureSums> pictures(tracer.transport->sensors.begin(),
                                    tracer.transport->sensors.end());
  for (int group = 0; group < groups; ++group) {
    std::vector<Complex> values(pixels * static_cast<std::size_t>(bins.sums()));
    Film film(static_cast<int>(pixels), bins, values);
    tracer.add(pairs_per_group, random, film, counts);
    if (work(counts, tracers, tracer.method) > most_work) return std::nullopt;
    std::vector<double> steady(pixels);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
      for (int part = 0; part < bins.parts(); ++part)
        steady[pixel] +=
            values[pixel * static_cast<std::size_t>(bins.sums()) + part].real() / pairs_per_group;
    std::size_t first = 0;
    for (PictureSums& picture : pictures) {
      picture.add(std::span(steady).subspan(first, picture.pixels()));
      first += picture.pixels();
    }
  }
  Trial trial{{}, work(counts, tracers, tracer.method)};
  for (const PictureSums& picture : pictures) trial.pictures.push_back(picture.moments());
  return trial;
}

/// A few pairs of paths, then as many as the work allows, `effort` times the usual.
std::optional<Trial> tried(const Tracers& tracers, const Tracer& tracer, double effort) {
  const double usual = tracers.plan().curved ? 1 << 15 : 1 << 17;
  if (!(tracer.flights_per_pair * tracers.cost_of_flight() * groups < usual)) return std::nullopt;
  const auto few = tried(tracers, tracer, 1, usual);
  if (!few) return few;
  const auto pairs = static_cast<int>(effort * usual / few->work);
  return pairs > 1 ? tried(tracers, tracer, pairs, 8 * effort * usual) : few;
}

/// Fewer groups with the light tell nothing of the variance.
constexpr double fewest_lit = groups / 4.0;

struct Candidate {
  Tracer tracer;
  Trial trial;
};

/// That of each picture, as the trial has it whose paths share it most evenly.
std::vector<double> light_of_pictures(const std::vector<Candidate>& candidates) {
  std::vector<PictureMoments> best = candidates.front().trial.pictures;
  for (const Candidate& candidate : candidates)
    for (std::size_t i = 0; i < best.size(); ++i)
      if (candidate.trial.pictures[i].lit > best[i].lit) best[i] = candidate.trial.pictures[i];
  std::vector<double> light;
  for (const PictureMoments& picture : best) light.push_back(picture.total);
  return light;
}

/// Work to a given error, of the sensor for which it is most. Infinite where light was missed, or a
/// few paths have it.
double work_to_error(const Trial& trial, const std::vector<double>& light) {
  double most = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    const PictureMoments& picture = trial.pictures[i];
    if (!(light[i] > 0)) continue;
    if (!(picture.total > light[i] / 2 && picture.lit > fewest_lit))
      return std::numeric_limits<double>::infinity();
    most = std::max(most, picture.variance / (light[i] * light[i]));
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

namespace {

/// Bidirectional tracing first, if it can be tried; then so can the others.
std::vector<Candidate> candidates(const Tracers& tracers, double effort) {
  std::vector<Candidate> found;
  for (const RenderMethod method :
       {RenderMethod::bidirectional, RenderMethod::path, RenderMethod::light}) {
    if (!has_finite_variance(tracers.scene(), method)) continue;
    Tracer tracer = tracers.make(method);
    auto trial = tried(tracers, tracer, effort);
    if (trial) found.push_back({std::move(tracer), std::move(*trial)});
    if (found.empty()) break;
  }
  return found;
}

/// Nothing where no trial tells.
Candidate* best_of(std::vector<Candidate>& all) {
  constexpr double clearly = 0.8;  // bidirectional misses least where the trial is too short
  Candidate* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  const auto light = light_of_pictures(all);
  for (Candidate& candidate : all) {
    const double needed = work_to_error(candidate.trial, light);
    if (!(needed < least)) continue;
    least = candidate.tracer.method == RenderMethod::bidirectional ? clearly * needed : needed;
    best = &candidate;
  }
  return best;
}

/// Whether enough paths carry each picture of every candidate: fewer have too small a variance, as
/// the strongest are still missing. One that has next to no light by then is no match.
bool is_settled(const std::vector<Candidate>& all) {
  constexpr double enough = 0.75 * groups, next_to_none = 1.5;
  const auto pending = [](const PictureMoments& picture) {
    return picture.lit > next_to_none && picture.lit < enough;
  };
  return all.size() == 1 || std::none_of(all.begin(), all.end(), [&](const Candidate& candidate) {
           const auto& pictures = candidate.trial.pictures;
           return std::any_of(pictures.begin(), pictures.end(), pending);
         });
}

}  // namespace

Tracer best_tracer(const Tracers& tracers) {
  std::optional<Tracer> best;
  for (const double effort : {1, 8, 32}) {
    auto all = candidates(tracers, effort);
    if (all.empty()) break;
    Candidate* const found = best_of(all);
    if (!found) continue;
    best = std::move(found->tracer);
    if (is_settled(all)) break;
  }
  return best ? std::move(*best) : tracers.make(RenderMethod::bidirectional);
}

}  // namespace flatspeckle::grin

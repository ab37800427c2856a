#include "grin/render/methods/method_choice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace flatspeckle::grin {

namespace {

constexpr int groups = 256;

/// Of one sensor's picture, by a group of paths.
struct PictureMoments {
  double total = 0, variance = 0;  ///< mean of the sum over the pixels; sum of the variances
  double lit = 0;                  ///< how many groups have the light, at equal shares
  double doubt = 1;  ///< relative standard error of the variance; too small where it is near 1
};
struct MethodTrial {
  std::vector<PictureMoments> pictures;  ///< by sensor
  double work = 0;
};

/// In flights that tell |J|.
double flown(const TransportCounts& counts, const Tracers& tracers, const Tracer& tracer) {
  constexpr double steps_alone = 20;  // at both ends of a flight in lanes
  constexpr double alone = 1.5;       // one that sees no others
  const double side_by_side = tracers.scene().leapfrogs ? 0.25 : 0.35;
  const auto all = static_cast<double>(counts.flights);
  if (tracer.method == RenderMethod::analog)
    return all * std::min(side_by_side + steps_alone / tracers.steps_of_flight(), alone);
  if (tracer.spreading == Spreading::all) return all;
  const double again = all - static_cast<double>(counts.light_collisions);
  return 0.7 * all + 2 * again;  // to the boundary is further than to collisions
}

/// What costs time, in flights of cost 1, by clocks of the shipped scenes.
double work(const TransportCounts& counts, const Tracers& tracers, const Tracer& tracer) {
  const double per_promise = 0.3, per_join = 0.7, per_iteration = tracers.plan().curved ? 2 : 4;
  const auto joins = static_cast<double>(counts.joins);
  const double steps = flown(counts, tracers, tracer) + tracer.cost_of_closed_join * joins +
                       per_iteration * static_cast<double>(counts.connections.iterations);
  return tracers.cost_of_flight() * steps +
         per_promise * static_cast<double>(counts.joins_weighed) + per_join * joins;
}

/// Of the groups of one sensor's picture: the variance is that of the differences between each
/// group and the next.
class PictureSums {
 public:
  explicit PictureSums(const SensorEnd& sensor)
      : last_(static_cast<std::size_t>(sensor.pixels().count())) {}

  std::size_t pixels() const { return last_.size(); }
  void add(std::span<const double> group) {
    const double light = std::reduce(group.begin(), group.end());
    light_ += light;
    light_square_ += light * light;
    if (++count_ > 1) {
      const double apart = std::transform_reduce(
          group.begin(), group.end(), last_.begin(), 0.0, std::plus(),
          [](double now, double before) { return (now - before) * (now - before) / 2; });
      apart_ += apart;
      apart_square_ += apart * apart;
    }
    last_.assign(group.begin(), group.end());
  }
  PictureMoments moments() const {
    return {.total = light_ / groups,
            .variance = apart_ / (groups - 1),
            .lit = light_ > 0 ? light_ * light_ / light_square_ : 0,
            .doubt = apart_ > 0 ? std::sqrt(apart_square_) / apart_ : 0};
  }

 private:
  std::vector<double> last_;
  int count_ = 0;
  double light_ = 0, light_square_ = 0, apart_ = 0, apart_square_ = 0;
};

/// Nothing where the work is beyond all measure.
std::optional<MethodTrial> tried(const Tracers& tracers, const Tracer& tracer, int pairs_per_group,
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
    if (work(counts, tracers, tracer) > most_work) return std::nullopt;
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
  MethodTrial trial{{}, work(counts, tracers, tracer)};
  for (const PictureSums& picture : pictures) trial.pictures.push_back(picture.moments());
  return trial;
}

/// A few pairs of paths, then as many as the work allows, `effort` times the usual.
std::optional<MethodTrial> tried(const Tracers& tracers, const Tracer& tracer, double effort) {
  const double usual = tracers.plan().curved ? 1 << 16 : 1 << 18;
  const double most = 2 * usual;
  if (!(tracer.flights_per_pair * tracers.cost_of_flight() * groups < most)) return std::nullopt;
  const auto few = tried(tracers, tracer, 1, most);
  if (!few) return few;
  const auto pairs = static_cast<int>(effort * usual / few->work);
  return pairs > 1 ? tried(tracers, tracer, pairs, 8 * effort * usual) : few;
}

struct Candidate {
  Tracer tracer;
  MethodTrial trial = {};
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

/// Fewer groups with the light tell nothing of the variance.
constexpr double fewest_lit = 16;
/// With more doubt the strongest paths are likely still missing.
constexpr double most_doubt = 0.25;

/// Work to a given error, of the sensor for which it is most, and whether the trial knows it well.
struct Needed {
  double work = 0;
  double doubt = 0;  ///< largest of all sensors, relative: a standard error
  bool is_known = true;
};
Needed needed(const MethodTrial& trial, const std::vector<double>& light) {
  Needed most;
  for (std::size_t i = 0; i < light.size(); ++i) {
    const PictureMoments& picture = trial.pictures[i];
    if (!(light[i] > 0)) continue;
    most.doubt = std::max(most.doubt, picture.doubt);
    most.is_known &= picture.lit > fewest_lit && picture.doubt < most_doubt;
    const bool is_missing = !(picture.total > light[i] / 2 && picture.lit > fewest_lit);
    most.work =
        std::max(most.work, is_missing ? std::numeric_limits<double>::infinity()
                                       : trial.work * picture.variance / (light[i] * light[i]));
  }
  return most;
}

bool is_pinhole(const Sensor& sensor) {
  const auto* camera = std::get_if<Camera>(&sensor);
  return camera && camera->lens_radius == 0;
}

/// Light goes straight on everywhere.
bool has_even_index(const RenderScene& scene) {
  const auto* const field = std::get_if<Homogeneous>(&scene.field);
  if (field == nullptr) return false;
  const auto excess = [&](Part part) {
    return part == scene.stage.field_part() ? field->n_excess : scene.stage.excess_in(part);
  };
  for (Part part = around + 1; part < scene.stage.parts(); ++part)
    if (excess(part) != excess(around)) return false;
  return true;
}

/// Of sensors' paths: they hit such a light, or are joined to it without 1/r^2.
bool is_evenly_met(const RenderScene& scene, const Light& light) {
  return std::holds_alternative<FaceLight>(light) ||
         (std::holds_alternative<BeamLight>(light) && has_even_index(scene));
}

}  // namespace

bool has_finite_variance(const RenderScene& scene, RenderMethod method) {
  if (!render_plan(scene).scatters) return true;
  if (method == RenderMethod::path)
    return std::ranges::all_of(scene.lights,
                               [&](const Light& light) { return is_evenly_met(scene, light); });
  return method != RenderMethod::light ||
         std::none_of(scene.sensors.begin(), scene.sensors.end(), is_pinhole);
}

namespace {

/// Far from a beam the strongest of a sensor's paths are too rare for a pilot: what it sees of them
/// is too little, and looks certain.
bool can_be_tried(const RenderScene& scene, RenderMethod method) {
  const auto is_beam = [](const Light& light) { return std::holds_alternative<BeamLight>(light); };
  return has_finite_variance(scene, method) &&
         (method != RenderMethod::path || std::ranges::none_of(scene.lights, is_beam) ||
          !render_plan(scene).scatters);
}

/// Bidirectional tracing first, if it can be tried; then so can the others.
std::vector<Candidate> candidates(const Tracers& tracers) {
  std::vector<Candidate> found;
  for (const RenderMethod method :
       {RenderMethod::bidirectional, RenderMethod::path, RenderMethod::light})
    if (can_be_tried(tracers.scene(), method)) found.push_back({tracers.make(method)});
  if (tracers.plan().curved && can_be_analog(tracers.scene()))
    found.push_back({tracers.make(RenderMethod::analog)});
  return found;
}

/// Leaves out those that cannot be tried: all where the first cannot.
void try_all(const Tracers& tracers, double effort, std::vector<Candidate>& all) {
  const auto is_beyond = [&](Candidate& candidate) {
    auto trial = tried(tracers, candidate.tracer, effort);
    if (trial) candidate.trial = std::move(*trial);
    return !trial;
  };
  if (all.empty() || is_beyond(all.front())) return all.clear();
  all.erase(std::remove_if(all.begin() + 1, all.end(), is_beyond), all.end());
}

/// What else speaks for or against a method, as a factor of its work. Bidirectional tracing misses
/// least where the trial is too short. Of light that is joined to nothing few paths hit a pixel:
/// it stays marked for long (PictureErrors), with bounds in place of errors.
double preference(const Tracer& tracer) {
  if (tracer.method == RenderMethod::bidirectional) return 0.9;
  const bool are_pixels =
      tracer.transport->pixels() > static_cast<int>(tracer.transport->sensors.size());
  return tracer.method == RenderMethod::analog && are_pixels ? 2 : 1;
}

/// Of each method, with its preference.
std::vector<Needed> needs_of(const std::vector<Candidate>& all) {
  const auto light = light_of_pictures(all);
  std::vector<Needed> needs;
  for (const Candidate& candidate : all) {
    needs.push_back(needed(candidate.trial, light));
    needs.back().work *= preference(candidate.tracer);
  }
  return needs;
}

/// Which has the least work, known or not. Nothing where no trial tells.
std::optional<std::size_t> best_of(const std::vector<Needed>& needs, bool of_known) {
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < needs.size(); ++i) {
    if ((of_known && !needs[i].is_known) || !(needs[i].work < least)) continue;
    best = i;
    least = needs[i].work;
  }
  return best;
}

/// Known well, and within two standard errors no other that finds the light needs much less.
bool is_settled(const std::vector<Needed>& needs, std::size_t best) {
  constexpr double much = 1.5;
  const double most = needs[best].work * (1 + 2 * needs[best].doubt);
  for (std::size_t i = 0; i < needs.size(); ++i) {
    const double least = needs[i].work * std::max(1 - 2 * needs[i].doubt, 0.0);
    if (i != best && std::isfinite(needs[i].work) && most > much * least) return false;
  }
  return needs[best].is_known;
}

}  // namespace

/// Trials go on, longer and longer, until the best is settled: an estimate that still lacks the
/// strongest paths is too good. After the last, one that is known goes before others.
Tracer best_tracer(const Tracers& tracers) {
  if (!tracers.walks()) return tracers.make(RenderMethod::light);
  auto all = candidates(tracers);
  std::vector<Needed> needs;
  std::optional<std::size_t> best;
  for (const double effort : {1, 4, 16}) {
    try_all(tracers, effort, all);
    if (all.empty()) return tracers.make(RenderMethod::bidirectional);
    needs = needs_of(all);
    best = best_of(needs, false);
    if (all.size() == 1 || (best && is_settled(needs, *best))) break;
  }
  if (best && !needs[*best].is_known)
    if (const auto known = best_of(needs, true)) best = known;
  return all[best.value_or(0)].tracer;
}

}  // namespace flatspeckle::grin

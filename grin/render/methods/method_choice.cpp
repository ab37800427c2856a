#include "grin/render/methods/method_choice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "core/numbers/statistics.h"

namespace flatspeckle::grin {

namespace {

constexpr int groups = 256;

/// Statistics of one sensor's picture over groups of paths.
struct PictureMoments {
  /// total: mean of the sum over the pixels; variance: sum of the variances of the pixels.
  double total = 0, variance = 0;
  double lit = 0;  ///< effective number of groups with light
  /// Relative standard error of the variance; an estimate near 1 is too low.
  double variance_error = 1;
};
struct MethodTrial {
  std::vector<PictureMoments> pictures;  ///< statistics of the picture of each sensor
  double work = 0;
};

/// Returns the cost of the flights of a trial, in units of one flight for which |J| is computed.
double flown(const TransportCounts& counts, const Tracers& tracers, const Tracer& tracer) {
  // steps made one ray at a time at both ends of a flight in lanes
  constexpr double steps_alone = 20;
  constexpr double alone = 1.5;  // cost of a flight outside of lanes
  const double side_by_side = tracers.scene().leapfrogs ? 0.25 : 0.35;
  constexpr double straight = 0.5;  // flights without connections along straight rays
  const auto all = static_cast<double>(counts.flights);
  if (tracer.method == RenderMethod::forward && !tracers.plan().curved) return straight * all;
  if (tracer.method == RenderMethod::forward)
    return all * std::min(side_by_side + steps_alone / tracers.steps_of_flight(), alone);
  if (tracer.spreading == Spreading::all) return all;
  const double again = all - static_cast<double>(counts.light_collisions);
  return 0.7 * all + 2 * again;  // flights to the boundary are longer than those to collisions
}

/// Returns the work of a trial, in units of flights of cost 1 (Tracers::cost_of_flight); the
/// coefficients are fitted to timings of the shipped scenes.
double work(const TransportCounts& counts, const Tracers& tracers, const Tracer& tracer) {
  const double per_expected_contribution = 0.3, per_connection = 0.7,
               per_iteration = tracers.plan().curved ? 2 : 4;
  const auto connections_made = static_cast<double>(counts.connections_made);
  const double steps = flown(counts, tracers, tracer) +
                       tracer.cost_of_closed_connection * connections_made +
                       per_iteration * static_cast<double>(counts.connections.iterations);
  return tracers.cost_of_flight() * steps +
         per_expected_contribution * static_cast<double>(counts.connections_weighed) +
         per_connection * connections_made;
}

/// Accumulates the groups of one sensor's picture. The variance is estimated from the differences
/// between successive groups or, for the total of a sensor of one pixel, with control variates.
class PictureSums {
 public:
  PictureSums(const SensorEnd& sensor, bool is_controlled)
      : last_(static_cast<std::size_t>(sensor.pixels().count())) {
    if (is_controlled && last_.size() == 1) controlled_.emplace(1 + control_variate_count);
  }

  std::size_t pixels() const { return last_.size(); }
  void add(std::span<const double> group, const ControlVariates::Sums& controls) {
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
    if (!controlled_) return;
    std::vector<Complex> sums{light};
    sums.insert(sums.end(), controls.begin(), controls.end());
    controlled_->add(1, sums);
  }
  PictureMoments moments() const {
    return {.total = light_ / groups,
            .variance = controlled_ ? controlled_variance() : apart_ / (groups - 1),
            .lit = light_ > 0 ? light_ * light_ / light_square_ : 0,
            .variance_error = apart_ > 0 ? std::sqrt(apart_square_) / apart_ : 0};
  }

 private:
  double controlled_variance() const {
    std::vector<std::size_t> of_controls(control_variate_count);
    std::iota(of_controls.begin(), of_controls.end(), std::size_t{1});
    const auto light = [](double samples, std::span<const Complex> sums) {
      return sample_mean(samples, sums.first(1));
    };
    const double error = controlled_jackknife(*controlled_, light, of_controls).error[0];
    return groups * error * error;
  }

  std::vector<double> last_;
  std::optional<GroupedSums> controlled_;  ///< light and control variates
  int count_ = 0;
  double light_ = 0, light_square_ = 0, apart_ = 0, apart_square_ = 0;
};

/// Sensor paths start in the same pixels in every group of a trial while this exists, so that the
/// differences between groups are those of paths and not of pixels.
class SamePixels {
 public:
  explicit SamePixels(Transport& transport) : transport_(transport) {
    transport_.keeps_pixels = true;
  }
  ~SamePixels() { transport_.keeps_pixels = false; }
  SamePixels(const SamePixels&) = delete;
  SamePixels& operator=(const SamePixels&) = delete;

 private:
  Transport& transport_;
};

/// Runs a trial of a method; returns nullopt if its work exceeds most_work.
std::optional<MethodTrial> tried(const Tracers& tracers, const Tracer& tracer, int pairs_per_group,
                                 double most_work) {
  constexpr auto no_batch = std::numeric_limits<std::uint64_t>::max() - 1000;
  const TimeBins steady;
  const auto pixels = static_cast<std::size_t>(tracer.transport->pixels());
  const SamePixels same(*tracer.transport);
  TransportCounts counts;
  std::vector<PictureSums> pictures;
  for (const SensorEnd& sensor : tracer.transport->sensors)
    pictures.emplace_back(sensor, tracer.has_control_variates);
  for (int group = 0; group < groups; ++group) {
    std::vector<Complex> values(pixels);
    Film film(static_cast<int>(pixels), steady, values);
    RandomStream random(0, static_cast<std::uint64_t>(Stream::render),
                        no_batch - static_cast<std::uint64_t>(group));
    tracer.add(pairs_per_group, random, film, counts);
    if (work(counts, tracers, tracer) > most_work) return std::nullopt;
    std::vector<double> light = real_parts(values);
    for (double& value : light) value /= pairs_per_group;
    std::size_t first = 0;
    for (PictureSums& picture : pictures) {
      picture.add(std::span(light).subspan(first, picture.pixels()), film.control_variates);
      first += picture.pixels();
    }
  }
  MethodTrial trial{{}, work(counts, tracers, tracer)};
  for (const PictureSums& picture : pictures) trial.pictures.push_back(picture.moments());
  return trial;
}

/// Runs a trial with one light path and its sensor paths per group, then a trial with as many such
/// pairs per group as `effort` times the usual work allows, or the whole pictures that this allows.
std::optional<MethodTrial> tried(const Tracers& tracers, const Tracer& tracer, double effort) {
  const double usual = tracers.plan().curved ? 1 << 16 : 1 << 18;
  const double most = 2 * usual;
  if (!(tracer.flights_per_pair * tracers.cost_of_flight() * groups < most)) return std::nullopt;
  const auto few = tried(tracers, tracer, 1, most);
  if (!few) return few;
  auto pairs = static_cast<int>(effort * usual / few->work);
  int pixels = 1;
  for (const SensorEnd& sensor : tracer.transport->sensors)
    pixels = std::max(pixels, sensor.pixels().count());
  if (pairs > pixels) pairs -= pairs % pixels;
  return pairs > 1 ? tried(tracers, tracer, pairs, 8 * effort * usual) : few;
}

struct Candidate {
  Tracer tracer;
  MethodTrial trial = {};
};

/// Returns the total light of each sensor's picture, from the trial in which this light is spread
/// most evenly over the groups.
std::vector<double> light_of_pictures(const std::vector<Candidate>& candidates) {
  std::vector<PictureMoments> best = candidates.front().trial.pictures;
  for (const Candidate& candidate : candidates)
    for (std::size_t i = 0; i < best.size(); ++i)
      if (candidate.trial.pictures[i].lit > best[i].lit) best[i] = candidate.trial.pictures[i];
  std::vector<double> light;
  for (const PictureMoments& picture : best) light.push_back(picture.total);
  return light;
}

/// Smallest number of groups with light for a useful variance.
constexpr double fewest_lit = 16;
/// If the error of the variance is larger, the trial has likely missed the paths of highest weight.
constexpr double largest_variance_error = 0.25;

/// Work that a method requires for a given error, for the sensor that requires the most; and
/// whether the estimate of this work is reliable.
struct Needed {
  double work = 0;
  double variance_error = 0;  ///< largest PictureMoments::variance_error of all sensors
  bool is_known = true;
};
Needed needed(const MethodTrial& trial, const std::vector<double>& light) {
  Needed most;
  for (std::size_t i = 0; i < light.size(); ++i) {
    const PictureMoments& picture = trial.pictures[i];
    if (!(light[i] > 0)) continue;
    most.variance_error = std::max(most.variance_error, picture.variance_error);
    most.is_known &= picture.lit > fewest_lit && picture.variance_error < largest_variance_error;
    const bool is_missing = !(picture.total > light[i] / 2 && picture.lit > fewest_lit);
    most.work =
        std::max(most.work, is_missing ? std::numeric_limits<double>::infinity()
                                       : trial.work * picture.variance / (light[i] * light[i]));
  }
  return most;
}

/// Whether the index is constant over the whole stage.
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

/// Lower bound of the distance from x to the nearest scattering medium; 0 in such a medium.
double distance_to_scattering(const Stage& stage, const Vec3& x) {
  double nearest = std::numeric_limits<double>::infinity();
  double depth = 0;  // depth of x in the innermost clear body that contains it
  for (const Body& body : stage.bodies)
    if (!(body.medium.mu_s > 0)) depth = std::max(depth, -distance(body.surface, x));
  if (stage.medium.mu_s > 0) nearest = depth;
  for (const Body& body : stage.bodies)
    if (body.medium.mu_s > 0) {
      const double outside = distance(body.surface, x);
      nearest = std::min(nearest, outside > 0 ? outside : std::min(depth, -outside));
    }
  return nearest;
}

/// Whether the variance of connections to this light is finite: sensor paths can hit the light, or
/// connect to it without a factor 1/r^2, or never scatter near it.
bool is_evenly_met(const RenderScene& scene, const Light& light) {
  if (std::holds_alternative<FaceLight>(light)) return true;
  if (std::holds_alternative<BeamLight>(light)) return has_even_index(scene);
  if (const auto* point = std::get_if<PointLight>(&light))
    return distance_to_scattering(scene.stage, point->x) > 0;
  const auto& fibre = std::get<FibreLight>(light);
  const double reach = fibre.spread == Spread::even ? fibre.radius : 3 * fibre.radius;
  return distance_to_scattering(scene.stage, fibre.centre) > reach;
}

bool is_pinhole_in_scattering(const RenderScene& scene, const Sensor& sensor) {
  const auto* camera = std::get_if<Camera>(&sensor);
  return camera && camera->lens_radius == 0 &&
         !(distance_to_scattering(scene.stage, camera->x) > 0);
}

}  // namespace

bool has_finite_variance(const RenderScene& scene, RenderMethod method) {
  if (!render_plan(scene).scatters) return true;
  if (method == RenderMethod::path)
    return std::ranges::all_of(scene.lights,
                               [&](const Light& light) { return is_evenly_met(scene, light); });
  return method != RenderMethod::light ||
         std::ranges::none_of(scene.sensors, [&](const Sensor& sensor) {
           return is_pinhole_in_scattering(scene, sensor);
         });
}

namespace {

/// Whether a pilot run can estimate the work of a method. Far from a beam the sensor paths of
/// highest weight are too rare for a pilot run, which would underestimate light and error.
bool can_be_tried(const RenderScene& scene, RenderMethod method) {
  const auto is_beam = [](const Light& light) { return std::holds_alternative<BeamLight>(light); };
  return has_finite_variance(scene, method) &&
         (method != RenderMethod::path || std::ranges::none_of(scene.lights, is_beam) ||
          !render_plan(scene).scatters);
}

/// Lists the methods to try, bidirectional tracing first.
std::vector<Candidate> candidates(const Tracers& tracers) {
  std::vector<Candidate> found;
  for (const RenderMethod method :
       {RenderMethod::bidirectional, RenderMethod::path, RenderMethod::light})
    if (can_be_tried(tracers.scene(), method)) found.push_back({tracers.make(method)});
  if (can_be_forward(tracers.scene())) found.push_back({tracers.make(RenderMethod::forward)});
  return found;
}

/// Runs the trials and removes candidates whose work is excessive; removes all candidates if the
/// work of the first is excessive.
void try_all(const Tracers& tracers, double effort, std::vector<Candidate>& all) {
  const auto is_beyond = [&](Candidate& candidate) {
    auto trial = tried(tracers, candidate.tracer, effort);
    if (trial) candidate.trial = std::move(*trial);
    return !trial;
  };
  if (all.empty() || is_beyond(all.front())) return all.clear();
  all.erase(std::remove_if(all.begin() + 1, all.end(), is_beyond), all.end());
}

/// Returns the preference for a method, a factor by which its work is multiplied. Bidirectional
/// tracing is preferred, since it misses least light if the trial is too short. Forward tracing of
/// pictures is avoided: few paths hit each pixel, so that pixels stay undersampled for long and
/// have bounds instead of errors (bound_errors). Connections through surfaces that refract are made
/// by random searches, whose rare contributions a trial underestimates.
double preference(const Tracer& tracer, bool refracts) {
  const bool are_pixels =
      tracer.transport->pixels() > static_cast<int>(tracer.transport->sensors.size());
  if (tracer.method == RenderMethod::forward) return are_pixels && !refracts ? 2 : 1;
  return tracer.method == RenderMethod::bidirectional ? 0.9 : 1;
}

/// Returns the work of each method, multiplied by its preference.
std::vector<Needed> needs_of(const std::vector<Candidate>& all, bool refracts) {
  const auto light = light_of_pictures(all);
  std::vector<Needed> needs;
  for (const Candidate& candidate : all) {
    needs.push_back(needed(candidate.trial, light));
    needs.back().work *= preference(candidate.tracer, refracts);
  }
  return needs;
}

/// Returns the method of least work; nullopt if there is none. of_known: consider only methods
/// whose work is known reliably.
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

/// Whether the estimate for the best method is reliable, and no other method that finds the light
/// could need much less work, allowing for two standard errors as factors.
bool is_settled(const std::vector<Needed>& needs, std::size_t best) {
  constexpr double much = 1.5;
  const double most = needs[best].work * (1 + 2 * needs[best].variance_error);
  for (std::size_t i = 0; i < needs.size(); ++i) {
    const double least = needs[i].work / (1 + 2 * needs[i].variance_error);
    if (i != best && std::isfinite(needs[i].work) && most > much * least) return false;
  }
  return needs[best].is_known;
}

/// Whether rare paths may carry much of the variance: path and light tracing sample each path in
/// one way only.
bool has_rare_paths(const Tracer& tracer) {
  return tracer.method == RenderMethod::path || tracer.method == RenderMethod::light;
}

/// Methods with their trials.
class Trials {
 public:
  explicit Trials(const Tracers& tracers)
      : tracers_(tracers),
        refracts_(!tracers.plan().curved && !has_even_index(tracers.scene())),
        all_(candidates(tracers)) {}

  /// Runs trials of all methods; returns whether one remains.
  bool run(double effort) {
    try_all(tracers_, effort, all_);
    if (!all_.empty()) compare();
    return !all_.empty();
  }
  bool is_settled() const {
    return all_.size() == 1 || (best_ && grin::is_settled(needs_, *best_));
  }
  /// Whether the best method is still the best after a trial of its own that is `effort` times as
  /// long, in which rare paths are found if there are any.
  bool is_confirmed(double effort) {
    if (all_.size() == 1 || !has_rare_paths(all_[*best_].tracer)) return true;
    const auto before = best_;
    const auto trial = tried(tracers_, all_[*best_].tracer, effort);
    if (!trial) return false;
    all_[*best_].trial = *trial;
    compare();
    return best_ == before && is_settled();
  }
  /// Returns the best method. Methods with reliable estimates are preferred.
  Tracer best() const {
    auto best = best_;
    if (best && !needs_[*best].is_known)
      if (const auto known = best_of(needs_, true)) best = known;
    return all_[best.value_or(0)].tracer;
  }

 private:
  void compare() {
    needs_ = needs_of(all_, refracts_);
    best_ = best_of(needs_, false);
  }

  const Tracers& tracers_;
  bool refracts_;
  std::vector<Candidate> all_;
  std::vector<Needed> needs_;
  std::optional<std::size_t> best_;
};

}  // namespace

/// Repeats trials of increasing length until the best method is settled: an estimate of the work is
/// too low if the trial lacks the paths of highest weight.
Tracer best_tracer(const Tracers& tracers) {
  if (!tracers.walks())
    return tracers.make(tracers.counts_rays() ? RenderMethod::forward : RenderMethod::light);
  // other methods starve at sensors that few paths reach, so that trials could not compare them
  if (tracers.are_guided()) return tracers.make(RenderMethod::forward);
  Trials trials(tracers);
  constexpr double longer = 4;
  for (const double effort : {1.0, longer, longer * longer}) {
    if (!trials.run(effort)) return tracers.make(RenderMethod::bidirectional);
    if (trials.is_settled() && (effort > 1 || trials.is_confirmed(longer))) break;
  }
  return trials.best();
}

}  // namespace flatspeckle::grin

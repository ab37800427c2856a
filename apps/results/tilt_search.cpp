#include "apps/results/tilt_search.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/error.h"
#include "core/run/runner.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::apps {

namespace {

constexpr double pi = std::numbers::pi;

/// Returns the amount by which the sines of the angles of the light and of all views can be
/// increased, slightly less than the largest possible one.
double largest_sine_step(const SceneSpec& spec) {
  constexpr double horizon = 0.99;
  double largest = std::sin(spec.light_angles.at(0));
  for (const double view : spec.view_angles) largest = std::max(largest, std::sin(view));
  if (largest >= horizon)
    throw InputError("tilt_count: a light or view is too close to the horizon; give tilts instead");
  return horizon - largest;
}

/// Returns the rotation of the light that increases the sine of its angle by sine_step.
double tilt_of(double light, double sine_step) {
  const double moved = std::asin(std::sin(light) + sine_step);
  return std::remainder((std::cos(light) >= 0 ? moved : pi - moved) - light, 2 * pi);
}

double to_four_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::stod(text);
}

constexpr int doublings = 20;

/// Returns the `count` smallest of a sequence of tilts. They change the sine of the light's angle
/// by largest / 2^20, ..., largest / 2, largest.
std::vector<double> doubling_tilts(const SceneSpec& spec, double largest, int count) {
  std::vector<double> tilts;
  for (int step = doublings; step > doublings - count; --step)
    tilts.push_back(tilt_of(spec.light_angles[0], std::ldexp(largest, -step)));
  return tilts;
}

/// Returns q at which C_I = 1/2, from a short run. If C_I = 1/2 is not reached, returns the largest
/// or smallest q of the scene's tilts as a bound (censored).
mc::Range pilot_range(const Scene& scene, bool transport, int threads, std::uint64_t seed) {
  constexpr double tolerance = 1e-2;
  constexpr std::uint64_t paths = 20000;
  const auto reversed = mc::ReversedPaths::no;
  const Estimation pilot = transport ? transport_estimation(scene, reversed, tolerance)
                                     : mc_estimation(scene, reversed, seed);
  RunOptions options;
  if (transport)
    options.stop = both_batches(tolerance);
  else
    options.stop.samples = paths;
  options.threads = threads;
  RunState state;
  run_to_end(pilot.job.batches, options, state);
  return mc::memory_effect(scene.request, state.sums, pilot.job.covariance).range.range;
}

/// Returns q at which C_I = 1/2. With transport, large tilts take the most time; they are tried
/// only if smaller tilts do not reach C_I = 1/2.
double found_range(const SceneSpec& spec, double largest, bool transport, int threads,
                   std::uint64_t seed) {
  constexpr int more = 4;
  SceneSpec pilot = spec;
  for (int count = transport ? more + 1 : doublings + 1;; count += more) {
    pilot.tilts = doubling_tilts(spec, largest, count);
    const auto range =
        pilot_range(with_dimension(make_scene(pilot), pilot), transport, threads, seed);
    if (range.censored != mc::Range::Censoring::above_value || count > doublings)
      return range.value;
  }
}

}  // namespace

void add_tilt_count_key(Keys& keys, std::optional<std::int64_t>& count) {
  keys.add("tilt_count", count,
           "Number of tilts, if tilts are not given: equidistant from 0 to twice the tilt at which "
           "C_I = 1/2, which a pilot run finds")
      .from(3, 1000)
      .only_of("covariance = memory_effect");
}

void add_q_depths_key(Keys& keys, std::vector<double>& q_depths) {
  keys.add("q_depths", q_depths,
           "Tilts given as q L, where L is the depth, instead of as angles (tilts)")
      .only_of("tilts of plane waves, where depth is given");
}

void take_q_depths(const Keys& keys, std::vector<double>& q_depths, SceneSpec& spec) {
  if (!keys.given(q_depths)) return;
  if (!spec.tilts.empty()) throw InputError("tilts, q_depths: exactly one must be given");
  keys.read(spec.wavelength);
  const double per_sine = 2 * pi / spec.outside_wavelength() * keys.required(spec.depth);
  const double light = keys.required(spec.light_angles).front();
  for (const double q_depth : keys.read(q_depths)) {
    if (std::abs(std::sin(light) + q_depth / per_sine) >= 1)
      throw InputError("q_depths", q_depth,
                       "tilts the light beyond the horizon: give a smaller value");
    spec.tilts.push_back(q_depth == 0 ? 0 : tilt_of(light, q_depth / per_sine));
  }
  q_depths.clear();
}

void choose_tilts(const Keys& keys, std::optional<std::int64_t>& count, SceneSpec& spec,
                  const std::string& method, const RunSettings& run, std::uint64_t seed) {
  if (!keys.given(count)) return;
  if (keys.read(spec.covariance) != "memory_effect")
    throw InputError("tilt_count", *count, "requires covariance = memory_effect");
  if (!spec.tilts.empty()) throw InputError("tilts, tilt_count: exactly one must be given");
  const double light = keys.required(spec.light_angles).front(), largest = largest_sine_step(spec),
               k = 2 * pi / spec.outside_wavelength();
  const double range =
      found_range(spec, largest, method == "transport", threads_of(keys, run), seed);
  const double end = std::min(2 * range / k, largest);
  const auto last = static_cast<double>(*count - 1);
  for (std::int64_t step = 0; step < *count; ++step)
    spec.tilts.push_back(to_four_digits(tilt_of(light, end * static_cast<double>(step) / last)));
  count.reset();
}

}  // namespace flatspeckle::apps

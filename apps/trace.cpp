#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <sstream>

#include <omp.h>

#include "apps/key_values.h"
#include "apps/ray_connections.h"
#include "apps/ray_tracing.h"
#include "apps/run_options.h"
#include "apps/subcommands.h"
#include "apps/trace_output.h"
#include "core/error.h"
#include "core/numbers/memory.h"
#include "core/result/provenance.h"
#include "core/result/result_file.h"
#include "core/run/stopwatch.h"
#include "grin/rays/light_speed.h"

namespace flatspeckle::apps {

namespace {

/// What the user asks.
struct TraceKeys {
  IndexFieldSpec field;
  RayStartSpec starts;
  RayStopSpec stops;
  ConnectSpec connect;
  std::int64_t path_points = 0;
  double length_unit = 1;
  RunSettings run;
};

void add_options(Options& options, TraceKeys& keys) {
  add_index_field_options(options, keys.field);
  add_ray_start_options(options, keys.starts);
  add_ray_stop_options(options, keys.stops);
  add_connect_options(options, keys.connect);
  options.add_with_default(
      "--path_points", keys.path_points,
      "Points of each ray in the file, to be drawn; also an index map (default 0: none)");
  options.add_with_default("--length_unit", keys.length_unit,
                           "Metres in a unit of length, for times");
  options.add_with_default("--seed", keys.run.seed, "Seed of the trials of connect");
  add_thread_option(options, keys.run);
  add_output_option(options, keys.run);
}

/// Of a light's rays: starts, ends and columns, and points twice, as rays and as columns.
void check_memory(const Subcommand& command, const TraceKeys& keys) {
  if (command.given("connect") || !keys.starts.rays.empty()) return;
  constexpr double ray = 600, point = 2 * sizeof(grin::Vec3);
  const double points = static_cast<double>(keys.path_points);
  const double bytes = static_cast<double>(keys.starts.ray_count) * (ray + point * points);
  const double memory = physical_memory();
  if (bytes > 0.8 * memory)
    throw InputError("ray_count", keys.starts.ray_count,
                     "with path_points = " + std::to_string(keys.path_points) + " needs " +
                         std::to_string(bytes / 1e9) + " GB of memory; there are " +
                         std::to_string(memory / 1e9));
}

void check(const Subcommand& command, const TraceKeys& keys) {
  constexpr std::int64_t most_points = 100'000;
  if (keys.path_points != 0 && (keys.path_points < 2 || keys.path_points > most_points))
    throw InputError("path_points", keys.path_points,
                     "must be 0 or from 2 to " + std::to_string(most_points));
  check_memory(command, keys);
  positive("length_unit", keys.length_unit);
  seed_of(keys.run);
  threads_of(keys.run);
  const bool connects = command.given("connect");
  for (const char* key : {"rays", "light", "ray_count", "origin", "direction", "across",
                          "beam_radius", "half_angle", "integrator", "tolerance"})
    if (connects && command.given(key))
      throw InputError(std::string(key) + ": connect has no use for it");
  if (!connects && command.given("trials"))
    throw InputError("trials", keys.connect.trials, "needs connect");
  if (keys.run.out.empty())
    throw InputError("out is not given: name the result file (--out FILE.h5)");
  check_result_path(keys.run.out);
}

/// How far from the z axis a ray may come.
double reach_of(const TraceKeys& keys, const std::vector<RayStart>& starts) {
  double reach = max_length_of(keys.stops);
  const auto& ends = keys.connect.connect;
  for (std::size_t i = 0; i + 1 < ends.size(); i += 3)
    reach = std::max(reach, std::hypot(ends[i], ends[i + 1]));
  for (const auto& start : starts) reach = std::max(reach, std::hypot(start.x[0], start.x[1]));
  return reach;
}

/// The largest coordinate where rays or curves start or end.
double farthest_of(const TraceKeys& keys, const std::vector<RayStart>& starts) {
  double farthest = 0;
  for (double x : keys.connect.connect) farthest = std::max(farthest, std::abs(x));
  for (const auto& start : starts) farthest = std::max(farthest, start.x.cwiseAbs().maxCoeff());
  return farthest;
}

struct Outcome {
  std::string plan, summary;
  double samples;
};

std::size_t path_points(const TraceKeys& keys) {
  return static_cast<std::size_t>(keys.path_points);
}

std::string plan_of(const RaySteps& steps) {
  std::ostringstream text;
  text << steps.integrator;
  if (steps.tolerance)
    text << ", tolerance " << *steps.tolerance << ", steps up to " << steps.longest;
  else
    text << ", step " << steps.longest;
  return text.str();
}

std::string ends_of(const std::vector<TracedRay>& rays, double length_unit) {
  std::size_t ends[3] = {};
  for (const auto& ray : rays) ++ends[static_cast<std::size_t>(ray.status)];
  std::ostringstream text;
  text << "ended: " << ends[0] << " on a stop surface, " << ends[1] << " at max_length";
  if (ends[2] > 0) text << ", " << ends[2] << " at the edge of the grid";
  const auto extremes =  // clang 14 captures no structured bindings
      std::minmax_element(rays.begin(), rays.end(), [](const TracedRay& a, const TracedRay& b) {
        return a.end.optical_path < b.end.optical_path;
      });
  const auto range = [&](const char* what, double unit, const char* name) {
    const double low = unit * extremes.first->end.optical_path;
    const double high = unit * extremes.second->end.optical_path;
    text << '\n' << what << std::setprecision(12) << low << " to " << high << name;
    text << std::setprecision(3) << ", spread " << high - low << name;
  };
  range("optical path ", 1, "");
  if (length_unit != 1) range("time ", length_unit / grin::light_speed, " s");
  return text.str();
}

Outcome trace_light(const Subcommand& command, const TraceKeys& keys, ResultFile& file) {
  const auto starts = make_ray_starts(command, keys.starts);
  const SceneField scene = make_index_field(command, keys.field, reach_of(keys, starts));
  const RayStops stops = make_ray_stops(keys.stops, scene.scale, farthest_of(keys, starts));
  const RaySteps steps = make_ray_steps(keys.stops, scene.scale);
  const auto rays = trace_rays(scene, stops, steps, starts, path_points(keys));
  write_rays(file, scene, starts, rays, keys.length_unit);
  if (keys.path_points > 0) write_paths(file, scene, rays);
  return {std::to_string(rays.size()) + (rays.size() == 1 ? " ray: " : " rays: ") + plan_of(steps),
          ends_of(rays, keys.length_unit), static_cast<double>(rays.size())};
}

/// How the trials ended, and what the user should know of that.
std::string trials_of(const FoundConnections& found) {
  static constexpr const char* ends[grin::trial_outcomes] = {
      "converged",       "came nowhere near",    "did not converge",
      "left the region", "grew over max_length", "met a caustic"};
  const auto& statistics = found.statistics;
  if (statistics.trials() == 0) return "a straight line, no trials needed";
  std::string text;
  for (int i = 0; i < grin::trial_outcomes; ++i)
    if (const auto count = statistics.outcomes[i]; count > 0)
      text += (text.empty() ? "trials: " : ", ") + std::to_string(count) + ' ' + ends[i];
  if (statistics.count(grin::TrialOutcome::degenerate) > 0)
    text += "\nnote: curves that meet in a caustic or image point at the end are not listed";
  constexpr std::uint64_t few = 5;
  if (std::ranges::any_of(found.curves, [](const auto& curve) { return curve.found < few; }))
    text += "\nnote: some curves were found less than 5 times; more trials may find others";
  return text;
}

std::string table_of(const FoundConnections& found) {
  std::ostringstream text;
  text << found.curves.size() << (found.curves.size() == 1 ? " curve" : " curves") << '\n';
  if (!found.curves.empty())
    text << "  optical path     arc length            |J|  caustics   found\n";
  for (const auto& [curve, times] : found.curves) {
    char line[160];
    std::snprintf(line, sizeof line, "%14.10g %14.10g %14.8g %9d %7llu\n", curve.optical_path,
                  curve.arc_length, curve.spreading, curve.caustics,
                  static_cast<unsigned long long>(times));
    text << line;
  }
  return text.str() + trials_of(found);
}

/// Each curve as a ray of its length, for its points.
std::vector<TracedRay> curve_rays(const SceneField& scene, const TraceKeys& keys,
                                  const FoundConnections& found, double step) {
  const auto& ends = keys.connect.connect;
  std::vector<TracedRay> rays;
  for (const auto& [curve, times] : found.curves) {
    const RayStops stops{{}, curve.arc_length, 1e-12 * curve.arc_length};
    const RayStart start{{ends[0], ends[1], ends[2]}, curve.start_direction};
    rays.push_back(trace_rays(scene, stops, {"sharma", step, {}}, {start}, path_points(keys))[0]);
  }
  return rays;
}

Outcome trace_curves(const Subcommand& command, const TraceKeys& keys, ResultFile& file) {
  SceneField scene = make_index_field(command, keys.field, reach_of(keys, {}));
  const RayStops stops = make_ray_stops(keys.stops, scene.scale, farthest_of(keys, {}));
  double step = make_ray_steps(keys.stops, scene.scale / 100).longest;
  if (!keys.stops.step) step /= largest_index(scene, keys.connect);
  const auto found = find_connections(scene, stops, step, keys.connect, seed_of(keys.run));
  write_connections(file, found, keys.length_unit);
  scene.rim.reset();  // curves stay inside
  if (keys.path_points > 0 && !found.curves.empty())
    write_paths(file, scene, curve_rays(scene, keys, found, step));
  std::ostringstream plan;
  plan << keys.connect.trials << " trials: sharma, step " << step;
  return {plan.str(), table_of(found), static_cast<double>(keys.connect.trials)};
}

void write_trace_provenance(ResultFile& file, const CommandLine& command_line,
                            const RunSettings& run, const std::string& started,
                            const Outcome& outcome, const Stopwatch& clock) {
  Provenance provenance{command_line.text, command_line.config, seed_of(run),
                        outcome.plan,      threads_of(run),     started};
  provenance.wall_s = clock.seconds();
  provenance.cpu_s = process_cpu_seconds();
  provenance.samples = outcome.samples;
  provenance.converged = true;
  write_provenance(file, provenance);
}

}  // namespace

int trace(const Arguments& arguments) {
  const Stopwatch clock;
  const std::string started = utc_now();
  TraceKeys keys;
  Subcommand command("trace", "Rays and the curves between two points in a gradient-index field");
  add_options(command.options(), keys);
  if (!command.parse(arguments)) return ExitStatus::done;
  check(command, keys);
  omp_set_num_threads(threads_of(keys.run));
  ResultFile file(keys.run.out);
  const Outcome outcome = command.given("connect") ? trace_curves(command, keys, file)
                                                   : trace_light(command, keys, file);
  write_trace_provenance(file, command.command_line(), keys.run, started, outcome, clock);
  file.commit();
  std::printf("%s\n%s\nwrote %s\n", outcome.plan.c_str(), outcome.summary.c_str(),
              keys.run.out.c_str());
  return ExitStatus::done;
}

}  // namespace flatspeckle::apps

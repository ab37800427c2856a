#include "apps/sweep/curve_sweep.h"

#include <algorithm>
#include <cmath>

#include "apps/results/tilt_search.h"
#include "apps/results/view_power.h"
#include "apps/sweep/point_store.h"
#include "core/error.h"
#include "core/result/version.h"
#include "core/session/session.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::apps {

namespace {

std::string header() {
  return "flatspeckle " + version() + ", sweep, format 2\n";
}

/// Whether some views are in transmission and others in reflection; a correlation averaged over both
/// is meaningless.
bool mixes_sides(const CovarianceRequest& request) {
  return std::any_of(request.views.begin(), request.views.end(), [&](const View& view) {
    return std::cos(view.angle) * std::cos(request.views.front().angle) < 0;
  });
}

void check_scene(const Scene& scene) {
  if (scene.medium.mu_s == 0)
    throw InputError("albedo", scene.medium.albedo,
                     "must be in (0, 1]: a medium that does not scatter has no correlation");
  if (mixes_sides(scene.request))
    throw InputError(
        "view_angles: C_E is averaged over all views; give only views in transmission or only views "
        "in reflection");
}

}  // namespace

CurveSweep::CurveSweep()
    : Sweep(
          "Memory-effect curves over any of g, albedo, optical depth, radius, index and density, "
          "by Monte Carlo, transport or exact solutions; with --of results of another subcommand "
          "over any of its keys") {
  base.scatterer = "hg";
  base.domain = "slab";
  base.covariance = "memory_effect";
  Keys& keys = this->keys();
  add_medium_keys(keys, base);
  add_scatterer_keys(keys, base);
  add_bulk_keys(keys, base);
  add_profile_keys(keys, base);
  add_sweep_keys(keys, lists_);
  add_structure_key(keys, base);
  add_view_keys(keys, base);
  keys.add("tilts", base.tilts, "Rotations of the light").angle();
  add_q_depths_key(keys, q_depths_);
  keys.group("Methods");
  keys.add("method", method_,
           "mc: Monte Carlo; wave: exact solutions; transport: deterministic, for slabs; both: mc "
           "and its reference, which is transport for slabs and wave for boxes; auto: transport "
           "for slabs if neither samples nor seconds are given, otherwise mc")
      .one_of({"mc", "wave", "transport", "both", "auto"});
  add_mc_keys(keys, methods);
  add_wave_keys(keys, methods);
  add_transport_keys(keys, methods);
  add_space_keys(keys, base);
  add_faces_keys(keys, base);
  add_run_keys(keys, run_);
  keys.remove("keep_state");  // this key applies only to a single run
  keys.group("Sweep of another subcommand");
  keys.add("of", of_,
           "Subcommand whose results are swept, such as render, over the keys in vary or points, "
           "instead of memory-effect curves; --of NAME --help lists its keys")
      .only_of("sweeps of another subcommand");
  add_vary_key(keys, vary_);
  keys.group("Run");
  add_share_key();
}

/// Checks all input. Each point must give a scene that the methods can compute.
void CurveSweep::check() {
  const Keys& keys = this->keys();
  take_q_depths(keys, q_depths_, base);
  choose_method(keys, method_, base, run_);
  method_words = method_ == "both"
                     ? std::vector<std::string>{"mc", base.domain == "slab" ? "transport" : "wave"}
                     : std::vector{method_};
  const auto has = [&](const char* word) { return std::ranges::count(method_words, word) > 0; };
  if (has("transport")) read_transport(keys, methods, base, run_);
  if (has("mc") || has("wave")) mc_stop_ = wave_stop_ = stop_rule(keys, run_);
  if (const auto& own = keys.read(methods.wave_samples); own && has("wave"))
    wave_stop_ = stop_rule(keys, run_, methods.wave_samples);
  for (StopRule* stop : {&mc_stop_, &wave_stop_})
    if (!stop->samples && !stop->target_error) stop->target_error = default_target_error;
  if (method_ != "wave") reversed_ = reversed_paths(keys, methods);
  if (has("wave")) keys.read(methods.wave_tolerance);
  keys.read(base.dimension);
  points_ = sweep_points(keys, lists_);
  check_points();
  disregard_unused(keys, base, method_words);
}

void CurveSweep::check_points() {
  // Checks the values of the keys at all points before any scene is made.
  each_run([](std::size_t, const Keyed<SceneSpec>&) {});
  Neglected neglected;
  bool flat_sample = false;
  each_run([&](std::size_t run, const Keyed<SceneSpec>& point) {
    const Scene scene = scene_of(point);
    keys().merge_reads(point.keys);
    check_scene(scene);
    flat_sample = flat_sample || (method(run) != "wave" && is_flat_sample(keys(), scene));
    if (method(run) == "wave") note_rounding(scene);
    if (method(run) == "wave" || point_of(run) == 0)
      estimation(run, scene);
    else if (method(run) == "mc")
      mc::require_walks(scene, mc::make_plan(scene, reversed_).weighted);
    if (method(run) != "wave") neglected.add(scene);
  });
  if (method_ != "wave") refuse_absurd(methods, neglected);
  note(neglected);
  if (flat_sample) note_plane();
}

/// Calls `use` for each run, with the keys of its point. For points from a table, messages of
/// InputError name the row.
void CurveSweep::each_run(
    const std::function<void(std::size_t run, const Keyed<SceneSpec>&)>& use) const {
  for (std::size_t run = 0; run < runs(); ++run) {
    try {
      with_point(run, [&](const Keyed<SceneSpec>& point) { use(run, point); });
    } catch (const InputError& error) {
      if (lists_.points.empty()) throw;
      const std::size_t row = point_of(run) + 1;
      throw InputError(lists_.points + ", row " + std::to_string(row) + ": " + error.what());
    }
  }
}

void CurveSweep::with_point(std::size_t run,
                            const std::function<void(const Keyed<SceneSpec>&)>& use) const {
  const Keyed<SceneSpec> point(base);
  set_point(points_, point_of(run), point.keys);
  point.keys.check();
  use(point);
}

Scene CurveSweep::scene_of(const Keyed<SceneSpec>& point) const {
  if (std::ranges::count(method_words, "wave") == 0) point.keys.read(point.values.dimension);
  const Scene scene = make_scene(point.keys, point.values);
  return with_dimension(method_words.size() > 1 ? rounded_scene(scene, point.values) : scene,
                        point.values);
}

Scene CurveSweep::scene(std::size_t run) const {
  Scene scene;
  with_point(run, [&](const Keyed<SceneSpec>& point) { scene = scene_of(point); });
  return scene;
}

Estimation CurveSweep::estimation(std::size_t run, const Scene& scene) const {
  if (method(run) == "transport") return transport_estimation(scene, reversed_, methods.tolerance);
  return method(run) == "mc" ? mc_estimation(scene, reversed_, session().seed())
                             : wave_estimation(scene, methods.wave_tolerance, session().seed());
}

StopRule CurveSweep::stop(std::size_t run) const {
  if (method(run) == "transport") return both_batches(methods.tolerance);
  return method(run) == "wave" ? wave_stop_ : mc_stop_;
}

std::string CurveSweep::name(std::size_t run) const {
  return method(run) + '_' + points_.name(point_of(run));
}

std::optional<std::size_t> CurveSweep::find(const std::string& name,
                                            const PointFinder& finder) const {
  for (std::size_t method = 0; method < method_words.size(); ++method) {
    const std::string prefix = method_words[method] + '_';
    if (!name.starts_with(prefix)) continue;
    if (const auto point = finder.find(name.substr(prefix.size()))) return run_of(method, *point);
  }
  return std::nullopt;
}

SweepRun CurveSweep::open(std::size_t run) const {
  const auto scene = std::make_shared<const Scene>(this->scene(run));
  const Estimation planned = estimation(run, *scene);
  const DoneWork work{method(run), 0, methods.tolerance_of(method(run)), session().seed()};
  return {planned.plan, planned.job.batches, stop(run),
          [scene, work, job = planned.job](ResultFile& file, const RunState& state) {
            write_curve(file, *scene, job, state);
            DoneWork done = work;
            done.samples = state.sums.total_samples();
            check_power(file, "", *scene, done);
          }};
}

/// Returns the keys and values of the sweep as text, except the keys that define points and methods
/// and those that affect no result.
std::string CurveSweep::identity_of_points() const {
  auto left_out = keys_of_the_work;
  left_out.insert(lists_.keys.begin(), lists_.keys.end());
  left_out.insert({"points", "method"});
  return header() + keys().config(left_out) + inputs_text(scene(0)) + inputs_text(keys());
}

std::string CurveSweep::identity() const {
  std::string all = header() + keys().config(keys_of_the_work);
  if (points_.is_list)
    for (std::size_t point = 0; point < points_.count(); ++point) all += points_.name(point) + '\n';
  return all;
}

bool CurveSweep::has_all_runs(std::size_t point, const PointStore& store) const {
  for (std::size_t method = 0; method < method_words.size(); ++method)
    if (!store.has(run_of(method, point))) return false;
  return true;
}

std::size_t CurveSweep::finished_points(const PointStore& store) const {
  std::size_t finished = 0;
  for (std::size_t point = 0; point < points_.count(); ++point)
    finished += has_all_runs(point, store) ? 1 : 0;
  return finished;
}

}  // namespace flatspeckle::apps

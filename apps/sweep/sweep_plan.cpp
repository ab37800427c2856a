#include "apps/sweep/sweep_plan.h"

#include <algorithm>
#include <cmath>

#include "apps/results/tilt_search.h"
#include "core/error.h"
#include "core/result/version.h"
#include "core/session/identity.h"
#include "mc/walk/plan.h"

namespace flatspeckle::apps {

namespace {

std::string header() {
  return "flatspeckle " + version() + ", sweep, format 2\n";
}

/// Both transmission and reflection: their sum says nothing.
bool mixes_sides(const CovarianceRequest& request) {
  return std::any_of(request.views.begin(), request.views.end(), [&](const View& view) {
    return std::cos(view.angle) * std::cos(request.views.front().angle) < 0;
  });
}

void check_scene(const Scene& scene) {
  if (scene.medium.mu_s == 0)
    throw InputError("albedo", scene.medium.albedo,
                     "what does not scatter has no correlation; must be in (0, 1]");
  if (mixes_sides(scene.request))
    throw InputError(
        "view_angles: C_E is of all views together: give those in transmission or those in "
        "reflection");
}

}  // namespace

SweepPlan::SweepPlan()
    : command_("sweep",
               "Memory-effect curves over any of g, albedo, optical depth, radius, index and "
               "density, by Monte Carlo, exactly, or both; with --of another subcommand's results "
               "over any of its keys") {
  base.scatterer = "hg";
  base.domain = "slab";
  base.covariance = "memory_effect";
  Keys& keys = command_.keys();
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
           "Monte Carlo, exactly, of slabs by transport without chance; both: Monte Carlo and what "
           "it is checked by; auto: of slabs transport, unless samples or seconds are given")
      .one_of({"mc", "wave", "transport", "both", "auto"});
  add_mc_keys(keys, methods);
  add_wave_keys(keys, methods);
  add_transport_keys(keys, methods);
  add_dimension_key(keys, base);
  add_run_keys(keys, settings);
  keys.remove("keep_state");  // of one run
  keys.group("Sweep of another subcommand");
  keys.add("of", of_,
           "Its name, as render: results of it over keys that vary or points name, in place of "
           "memory-effect curves (then --help --of NAME has its keys)")
      .only_of("sweeps of another subcommand");
  add_vary_key(keys, vary_);
  keys.group("Run");
  keys.add("shard", share_,
           "i/n: work on every nth point only, from number i = 0 .. n - 1 on; then merge")
      .no_file();
}

bool SweepPlan::read() {
  session_.emplace(command_.text(), command_.keys(), settings, command_.only_prints(),
                   Session::Out::shared);
  check();
  return command_.settle();
}

void SweepPlan::parse_config(const std::string& config, const std::string& command_line) {
  command_.parse_config(config);
  session_.emplace(command_line, command_.keys(), settings, true);
  check();
}

/// All that can be refused: every point must make a scene that the method can take.
void SweepPlan::check() {
  const Keys& keys = command_.keys();
  take_q_depths(keys, q_depths_, base);
  choose_method(keys, method_, base, settings);
  method_words = method_ == "both"
                     ? std::vector<std::string>{"mc", base.domain == "slab" ? "transport" : "wave"}
                     : std::vector{method_};
  const auto has = [&](const char* word) { return std::ranges::count(method_words, word) > 0; };
  if (has("transport")) read_transport(keys, methods, base, settings);
  if (has("mc") || has("wave")) mc_stop_ = wave_stop_ = stop_rule(keys, settings);
  if (const auto& own = keys.read(methods.wave_samples); own && has("wave"))
    wave_stop_ = stop_rule(keys, settings, methods.wave_samples);
  for (StopRule* stop : {&mc_stop_, &wave_stop_})
    if (!stop->samples && !stop->target_error) stop->target_error = default_target_error;
  if (!keys.read(share_).empty()) share = share_of(share_);
  if (method_ != "wave") reversed_ = reversed_paths(keys, methods);
  if (has("wave"))
    keys.read(methods.wave_tolerance);
  else
    keys.read(base.dimension);
  points = sweep_points(keys, lists_);
  check_points();
  disregard_unused(keys, base, method_words);
}

void SweepPlan::check_points() {
  each_run([](std::size_t, const Keyed<SceneSpec>&) {});  // the values of all, before any scene
  Neglected neglected;
  each_run([&](std::size_t run, const Keyed<SceneSpec>& point) {
    const Scene scene = scene_of(point);
    command_.keys().join_reads(point.keys);
    check_scene(scene);
    if (method(run) == "wave") note_rounding(scene);
    if (method(run) == "wave" || point_of(run) == 0)
      estimation(run, scene);
    else if (method(run) == "mc")
      mc::require_walks(scene, mc::make_plan(scene, reversed_).weighted);
    if (method(run) != "wave") neglected.add(scene);
  });
  if (method_ != "wave") refuse_absurd(methods, neglected);
  note(neglected);
}

/// Where points come from a table, says which row cannot be used.
void SweepPlan::each_run(
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

void SweepPlan::with_point(std::size_t run,
                           const std::function<void(const Keyed<SceneSpec>&)>& use) const {
  const Keyed<SceneSpec> point(base);
  points.set(point_of(run), point.keys);
  point.keys.check();
  use(point);
}

Scene SweepPlan::scene_of(const Keyed<SceneSpec>& point) const {
  const Scene scene = make_scene(point.keys, point.values);
  return with_dimension(method_words.size() > 1 ? rounded_scene(scene, point.values) : scene,
                        point.values);
}

Scene SweepPlan::scene(std::size_t run) const {
  Scene scene;
  with_point(run, [&](const Keyed<SceneSpec>& point) { scene = scene_of(point); });
  return scene;
}

Estimation SweepPlan::estimation(std::size_t run, const Scene& scene) const {
  if (method(run) == "transport") return transport_estimation(scene, reversed_, methods.tolerance);
  return method(run) == "mc" ? mc_estimation(scene, reversed_, session().seed())
                             : wave_estimation(scene, methods.wave_tolerance, session().seed());
}

StopRule SweepPlan::stop(std::size_t run) const {
  if (method(run) == "transport") return both_batches();
  return method(run) == "wave" ? wave_stop_ : mc_stop_;
}

std::string SweepPlan::name(std::size_t run) const {
  return method(run) + '_' + points.name(point_of(run));
}

/// Of the sweep's keys all but those that say which points and methods there are.
std::string SweepPlan::identity(std::size_t run) const {
  auto left_out = keys_of_the_work;
  left_out.insert(lists_.keys.begin(), lists_.keys.end());
  left_out.insert({"points", "method"});
  return header() + command_.keys().config(left_out) + name(run) + '\n' + inputs_text(scene(run)) +
         inputs_text(command_.keys());
}

std::string SweepPlan::identity() const {
  std::string all = header() + command_.keys().config(keys_of_the_work);
  if (points.is_list)
    for (std::size_t point = 0; point < points.count(); ++point) all += points.name(point) + '\n';
  return all;
}

}  // namespace flatspeckle::apps

#include "apps/sweep_plan.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "apps/scene_options.h"
#include "core/error.h"
#include "core/result/version.h"

namespace flatspeckle::apps {

namespace {

/// Keys that change no number of any run.
const std::vector<std::string> keys_of_the_work{"threads", "resume", "seconds"};

std::string header() {
  return "flatspeckle " + version() + ", sweep, format 2\n";
}

/// The parser of `sweep` and where it puts what it reads.
class SweepParser {
 public:
  SweepParser()
      : subcommand_("sweep",
                    "Memory-effect curves over any of g, albedo, optical depth, radius, "
                    "index and density, by Monte Carlo, exactly, or both") {
    plan_.base.scatterer = "hg";
    plan_.base.domain = "slab";
    plan_.base.covariance = "memory_effect";
    auto& options = subcommand_.options();
    add_scatterer_options(options, plan_.base);
    add_medium_options(options, plan_.base);
    for (const char* key : {"--radius", "--index", "--density"}) options.remove(key);  // lists here
    add_sweep_options(options, lists_);
    add_structure_option(options, plan_.base);
    add_view_options(options, plan_.base);
    options.add("--tilts", plan_.base.tilts, "Rotations of the light, radians");
    options.add_with_default("--method", method_, "mc, wave or both");
    options.add("--shard", share_,
                "i/n: work on every nth point only, from number i = 0 .. n - 1 on; then merge");
    options.keep_out_of_scene_file("--shard");
    add_mc_options(options, plan_.methods);
    add_wave_options(options, plan_.methods);
    add_run_options(options, plan_.settings);
  }

  Subcommand& subcommand() { return subcommand_; }

  /// What was parsed, checked.
  SweepPlan plan();

 private:
  Subcommand subcommand_;
  SweepPlan plan_;
  SweepLists lists_;
  std::string method_ = "mc", share_;
};

SweepShare share_of(const std::string& text) {
  SweepShare share;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, share.number);
  const bool slash = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
  const auto count = slash ? std::from_chars(number.ptr + 1, end, share.count) : number;
  if (!slash || count.ec != std::errc{} || count.ptr != end || share.number >= share.count)
    throw InputError("shard", text, "must be i/n with 0 <= i < n");
  return share;
}

std::vector<std::string> methods_of(const std::string& word) {
  if (word == "both") return {"mc", "wave"};
  if (word != "mc" && word != "wave")
    throw InputError("method", word, "must be one of mc wave both");
  return {word};
}

/// Both transmission and reflection: their sum says nothing.
bool mixes_sides(const CovarianceRequest& request) {
  return std::any_of(request.views.begin(), request.views.end(), [&](const View& view) {
    return std::cos(view.angle) * std::cos(request.views.front().angle) < 0;
  });
}

void check_scene(const SweepPlan& plan, std::size_t run, const Scene& scene) {
  plan.stop(run);  // checks
  if (scene.medium.mu_s == 0)
    throw InputError("albedo", scene.medium.albedo,
                     "what does not scatter has no correlation; must be in (0, 1]");
  if (mixes_sides(scene.request))
    throw InputError(
        "view_angles: C_E is of all views together: give those in transmission or those in "
        "reflection");
  if (plan.method(run) == "wave") note_rounding(scene);
  if (plan.method(run) == "wave" || run == 0) plan.estimation(run, scene);
}

/// Every point must make a scene that the method can take. Where they come from a table, says which
/// row does not.
void check_points(const SweepPlan& plan, const std::string& table) {
  Neglected neglected;
  for (std::size_t run = 0; run < plan.runs(); ++run) {
    try {
      const Scene scene = plan.scene(run);
      check_scene(plan, run, scene);
      if (plan.method(run) == "mc") neglected.add(scene);
    } catch (const InputError& error) {
      if (table.empty()) throw;
      const std::size_t row = run % plan.points.points.size() + 1;
      throw InputError(table + ", row " + std::to_string(row) + ": " + error.what());
    }
  }
  note(neglected);
}

SweepPlan SweepParser::plan() {
  plan_.command = subcommand_.command_line();
  plan_.points = sweep_points(lists_);
  plan_.method_words = methods_of(method_);
  if (!share_.empty()) plan_.share = share_of(share_);
  seed_of(plan_.settings);
  stop_rule(plan_.settings);
  check_points(plan_, lists_.points);
  return plan_;
}

}  // namespace

Scene SweepPlan::scene(std::size_t run) const {
  SceneSpec spec = points.scene(base, points.points[run % points.points.size()]);
  if (method_words.size() > 1) round_density(spec);
  return make_scene(spec);
}

Estimation SweepPlan::estimation(std::size_t run, const Scene& scene) const {
  return (method(run) == "mc" ? mc_estimation : wave_estimation)(scene, methods, seed_of(settings));
}

StopRule SweepPlan::stop(std::size_t run) const {
  const bool wave = method(run) == "wave" && methods.wave_samples;
  StopRule stop =
      wave ? stop_rule(settings, "wave_samples", methods.wave_samples) : stop_rule(settings);
  if (!stop.samples && !stop.target_error) stop.target_error = default_target_error;
  return stop;
}

std::string SweepPlan::name(std::size_t run) const {
  return method(run) + '_' + points.name(points.points[run % points.points.size()]);
}

std::string SweepPlan::identity(std::size_t run) const {
  auto left_out = keys_of_the_work;
  left_out.insert(left_out.end(), {"points", "method"});
  left_out.insert(left_out.end(), sweep_keys().begin(), sweep_keys().end());
  return header() + without_keys(command.config, left_out) + name(run) + '\n' +
         inputs_text(scene(run));
}

std::string SweepPlan::identity() const {
  std::string text = header() + without_keys_of_the_work(command.config);
  if (points.is_list)
    for (const SweepPoint& point : points.points) text += points.name(point) + '\n';
  return text;
}

std::string without_keys_of_the_work(const std::string& config) {
  return without_keys(config, keys_of_the_work);
}

std::optional<SweepPlan> sweep_plan(const Arguments& arguments) {
  SweepParser parser;
  if (!parser.subcommand().parse(arguments)) return std::nullopt;
  return parser.plan();
}

SweepPlan sweep_plan_of(const std::string& config) {
  SweepParser parser;
  parser.subcommand().parse_config(config);
  return parser.plan();
}

}  // namespace flatspeckle::apps

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/estimation.h"
#include "apps/scene_options.h"
#include "apps/subcommands.h"
#include "core/error.h"
#include "core/numbers/memory.h"
#include "core/result/provenance.h"
#include "core/result/result_file.h"
#include "core/run/interrupt.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/speckle/field_datasets.h"
#include "mc/speckle/speckle_field.h"

namespace flatspeckle::apps {

namespace {

/// What the user asks.
struct FieldKeys {
  SceneSpec spec;
  std::int64_t fields = 16;
  std::optional<std::int64_t> paths_per_field;
  double target_error = mc::FieldDemand().covariance_error;
  std::string method = "auto";
  MethodSettings estimation;
  RunSettings run;
};

void add_options(Options& options, FieldKeys& keys) {
  add_scatterer_options(options, keys.spec);
  add_bulk_options(options, keys.spec);
  add_medium_options(options, keys.spec);
  add_structure_option(options, keys.spec);
  add_view_options(options, keys.spec);
  options.add("--tilts", keys.spec.tilts,
              "Rotations of the light, radians: fields under each, in the same views");
  options.add_with_default("--fields", keys.fields, "How many realizations");
  options.add_with_default(
      "--method", keys.method,
      "paths (each field from light paths of its own), covariance (estimated first, "
      "then Cholesky) or auto (the cheaper)");
  options.add("--paths_per_field", keys.paths_per_field,
              "Light paths of each field (default: so many that the excess kurtosis is 0.01)");
  options.add_with_default("--target_error", keys.target_error,
                           "Relative error of the covariance that fields are drawn from");
  add_mc_options(options, keys.estimation);
  options.add_with_default("--seed", keys.run.seed, "Seed; field n of a seed is always the same");
  add_thread_option(options, keys.run);
  add_output_option(options, keys.run);
}

mc::FieldMethod method_named(const std::string& name) {
  using enum mc::FieldMethod;
  if (name == "auto") return automatic;
  if (name == "paths") return paths;
  if (name == "covariance") return covariance;
  throw InputError("method", name, "must be one of auto paths covariance");
}

mc::FieldDemand demand_of(const FieldKeys& keys) {
  mc::FieldDemand demand{.method = method_named(keys.method)};
  if (keys.fields < 2)
    throw InputError("fields", keys.fields, "must be at least 2, so that statistics have errors");
  demand.fields = static_cast<std::uint64_t>(keys.fields);
  if (keys.paths_per_field) {
    if (*keys.paths_per_field < 1)
      throw InputError("paths_per_field", *keys.paths_per_field, "must be positive");
    demand.paths_per_field = static_cast<std::uint64_t>(*keys.paths_per_field);
  }
  if (!(keys.target_error > 0 && keys.target_error < 1))
    throw InputError("target_error", keys.target_error, "must be in (0, 1)");
  demand.covariance_error = keys.target_error;
  return demand;
}

/// Lights: the reference light, rotated by each tilt.
void settle_tilts(SceneSpec& spec) {
  if (spec.tilts.empty()) return;
  if (spec.light_angles.size() != 1)
    throw InputError("tilts rotate one light: give one angle in light_angles");
  const double reference = spec.light_angles.front();
  spec.light_angles.clear();
  for (double tilt : spec.tilts) {
    if (!std::isfinite(tilt)) throw InputError("tilts", tilt, "must be finite");
    spec.light_angles.push_back(reference + tilt);
  }
  spec.tilts.clear();
}

Scene field_scene(SceneSpec spec) {
  if (spec.domain == "slab")
    throw InputError("domain", spec.domain,
                     "fields need a box: an infinite slab's speckles are infinitely fine");
  settle_tilts(spec);
  Scene scene = make_scene(spec);
  scene.request = mc::field_request(scene.request.lights, scene.request.views);
  return scene;
}

void check_memory(const Scene& scene, const mc::FieldDemand& demand) {
  constexpr double sums = 100;  // per channel, held beside the fields
  const auto channels = static_cast<double>(scene.request.channels.size());
  const double bytes = sizeof(Complex) * channels * (static_cast<double>(demand.fields) + sums);
  const double memory = physical_memory();
  if (bytes > 0.8 * memory)
    throw InputError("fields", demand.fields,
                     std::to_string(scene.request.channels.size()) + " channels need " +
                         std::to_string(bytes / 1e9) + " GB, this machine has " +
                         std::to_string(memory / 1e9));
  if (demand.method == mc::FieldMethod::covariance)
    full_request(scene.request.lights, scene.request.views);  // throws where that does not fit
}

void write_field_provenance(ResultFile& file, const Subcommand& command, const FieldKeys& keys,
                            const std::string& started, const std::string& plan,
                            const mc::DrawnFields& drawn) {
  Provenance provenance{command.command_line().text, command.command_line().config,
                        seed_of(keys.run),           "mc: " + plan + "; " + drawn.plan.describe(),
                        threads_of(keys.run),        started};
  provenance.wall_s = drawn.wall_s;
  provenance.cpu_s = drawn.cpu_s;
  provenance.samples = static_cast<double>(keys.fields);
  provenance.converged = true;
  write_provenance(file, provenance);
}

/// How the statistics of all fields compare with those of a circular Gaussian field.
void print_summary(const mc::DrawnFields& drawn, const mc::FieldSummary& summary) {
  const auto& [contrast, circularity, found] = summary;
  std::printf("contrast %.4f +- %.2g, |<u u>| / <I> %.2g +- %.2g (Gaussian: 1 and 0)\n",
              contrast.value[0].real(), contrast.error[0], std::abs(circularity.value[0]),
              circularity.error[0]);
  const Estimate& siegert = drawn.siegert;
  if (found.value.empty() || siegert.value.empty()) return;
  const bool by_paths = drawn.plan.method == mc::FieldMethod::paths;
  const double excess = by_paths ? drawn.plan.excess : 0;
  double deviation = 0;
  for (std::size_t d = 0; d < found.value.size(); ++d) {
    const double beyond = std::abs(found.value[d] - siegert.value[d]) - excess;
    const double error = std::hypot(found.error[d], siegert.error[d]);
    if (beyond > 0 && error > 0) deviation = std::max(deviation, beyond / error);
  }
  std::printf(
      "autocorrelation of the intensity: Siegert's relation within %.1f standard errors%s\n",
      deviation, by_paths ? " and the excess kurtosis" : "");
}

}  // namespace

int field(const Arguments& arguments) {
  const std::string started = utc_now();
  FieldKeys keys;
  Subcommand command("field", "Speckle fields of a scene, drawn with its covariance");
  add_options(command.options(), keys);
  if (!command.parse(arguments)) return ExitStatus::done;

  settle_request(command, keys.spec);
  const Scene scene = field_scene(keys.spec);
  const auto demand = demand_of(keys);
  check_memory(scene, demand);
  const mc::DrawingSettings settings{reversed_paths(keys.estimation), seed_of(keys.run),
                                     threads_of(keys.run)};
  const std::string plan = mc::make_plan(scene, settings.reversed).describe();
  const std::string& out = keys.run.out;
  if (out.empty()) throw InputError("out is not given: name the result file (--out FILE.h5)");
  check_result_path(out);
  catch_interrupts();
  const auto drawn = mc::draw_fields(scene, demand, settings, [](const mc::FieldPlan& chosen) {
    std::printf("%s\n", chosen.describe().c_str());
    std::fflush(stdout);
  });
  if (!drawn) return ExitStatus::interrupted_for_good;

  ResultFile file(out, ResultFile::Storage::disk);
  write_field_provenance(file, command, keys, started, plan, *drawn);
  write_medium(file, scene);
  print_summary(*drawn, mc::write_fields(file, scene, keys.spec.tilts, *drawn));
  file.commit();
  std::printf("wrote %s\n", out.c_str());
  return ExitStatus::done;
}

}  // namespace flatspeckle::apps

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/estimation.h"
#include "apps/moments_output.h"
#include "apps/scene_options.h"
#include "apps/session.h"
#include "apps/subcommands.h"
#include "core/error.h"
#include "mc/diffusion.h"
#include "mc/memory_effect.h"

namespace flatspeckle::apps {

namespace {

/// The axes of a sweep; an axis that is not swept keeps the scene's one value.
struct SweepAxes {
  std::vector<double> optical_depth, g, albedo;
};

struct SweepPoint {
  std::string name;
  Scene scene;
  FieldJob job;
  const GroupedSums* sums = nullptr;
};

std::vector<std::optional<double>> values_or_none(const std::vector<double>& values) {
  if (values.empty()) return {std::nullopt};
  return {values.begin(), values.end()};
}

/// Scenes in the order [optical_depth][g][albedo]; fills axes that were not given.
std::vector<Scene> sweep_scenes(const SceneSpec& spec, SweepAxes& axes) {
  std::vector<Scene> scenes;
  for (const auto& optical_depth : values_or_none(axes.optical_depth)) {
    for (const auto& g : values_or_none(axes.g)) {
      for (const auto& albedo : values_or_none(axes.albedo)) {
        SceneSpec point = spec;
        point.optical_depth = optical_depth;
        point.g = g;
        point.albedo = albedo;
        scenes.push_back(make_scene(point));
        if (scenes.back().medium.mu_s == 0)
          throw InputError("albedo", scenes.back().medium.albedo,
                           "what does not scatter has no correlation; must be in (0, 1]");
      }
    }
  }
  const Scene& first = scenes.front();
  if (axes.optical_depth.empty()) axes.optical_depth = {first.medium.mu_t * first.domain.depth};
  if (axes.g.empty()) axes.g = {first.medium.g};
  if (axes.albedo.empty()) axes.albedo = {first.medium.albedo};
  return scenes;
}

/// Everything the result holds, in the order of the points.
struct SweepTables {
  std::vector<double> correlation, correlation_error, diffusion, range, range_error;
  std::vector<std::uint64_t> censored;  ///< numbers of mc::Range::Censoring
  std::vector<std::string> shown_range;
  bool few = false;  ///< steps below some range

  void add(const SweepPoint& point) {
    const auto effect = mc::memory_effect(point.scene.request, *point.sums, point.job.covariance);
    const double depth = point.scene.domain.depth;
    correlation.insert(correlation.end(), effect.correlation.begin(), effect.correlation.end());
    correlation_error.insert(correlation_error.end(), effect.correlation_error.begin(),
                             effect.correlation_error.end());
    for (double q : point.scene.request.tilt_q)
      diffusion.push_back(mc::diffusion_field_correlation(point.scene.medium, depth, q));
    range.push_back(effect.range.value * depth);
    few = few || few_steps(point.scene.request.tilt_q, effect.range);
    range_error.push_back(effect.range_error * depth);
    shown_range.push_back(range_text({range.back(), effect.range.censored}, range_error.back()));
    censored.push_back(static_cast<std::uint64_t>(effect.range.censored));
  }
};

/// Diffusion theory is that of transmitted light.
bool transmission_only(const CovarianceRequest& request) {
  return std::all_of(request.views.begin(), request.views.end(),
                     [](const View& view) { return std::cos(view.angle) > 0; });
}

/// k mean_free_path per optical depth.
std::vector<double> small_parameter(const SweepAxes& axes, const Scene& scene) {
  std::vector<double> values;
  for (double optical_depth : axes.optical_depth)
    values.push_back(scene.k * scene.domain.depth / optical_depth);
  return values;
}

void write_tables(ResultFile& file, const SweepAxes& axes, const std::vector<SweepPoint>& points,
                  const SweepTables& tables) {
  const Scene& scene = points.front().scene;
  file.scale("optical_depth", axes.optical_depth, "1", "optical depth mu_t L");
  file.scale("g", axes.g, "1", "mean cosine of scattering");
  file.scale("albedo", axes.albedo, "1", "single-scattering albedo");
  write_axes(file, scene.request);
  file.dataset("k_mean_free_path", small_parameter(axes, scene), {"optical_depth"}, "1",
               "wavenumber times mean free path");
  const std::vector<Axis> grid = {"optical_depth", "g", "albedo"};
  const std::vector<Axis> curves = {"optical_depth", "g", "albedo", "tilt"};
  file.dataset("field_correlation", tables.correlation, curves, "1", "field correlation C_E");
  file.dataset("field_correlation_error", tables.correlation_error, curves, "1",
               "standard error: field correlation C_E");
  if (transmission_only(scene.request))
    file.dataset("diffusion_theory", tables.diffusion, curves, "1", "C_E in diffusion theory");
  file.dataset("memory_effect_range", tables.range, grid, "1", "q L at C_I = 1/2");
  file.dataset("memory_effect_range_error", tables.range_error, grid, "1",
               "standard error: q L at C_I = 1/2");
  file.attribute("memory_effect_range", "censored", tables.censored);
}

void print_ranges(const std::vector<SweepPoint>& points, const SweepTables& tables) {
  std::printf("%13s %8s %8s  %s\n", "optical depth", "g", "albedo", "range q L at C_I = 1/2");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& medium = points[i].scene.medium;
    std::printf("%13.5g %8.4g %8.6g  ", medium.mu_t * points[i].scene.domain.depth, medium.g,
                medium.albedo);
    std::puts(tables.shown_range[i].c_str());
  }
}

}  // namespace

int sweep(const Arguments& arguments) {
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.domain = "slab";
  spec.covariance = "memory_effect";
  RunSettings settings;
  MethodSettings methods;
  SweepAxes axes;
  Subcommand command("sweep", "Memory-effect curves over tilts x g x albedo x optical depth");
  auto& options = command.options();
  add_scatterer_options(options, spec);
  options.add_option("--g", axes.g, "Mean cosines of hg to sweep");
  options.add_option("--albedo", axes.albedo, "Albedos to sweep");
  options.add_option("--optical_depth", axes.optical_depth, "Optical depths to sweep");
  add_medium_options(options, spec);
  add_structure_option(options, spec);
  add_view_options(options, spec);
  options.add_option("--tilts", spec.tilts, "Rotations of the light, radians");
  add_mc_options(options, methods);
  add_run_options(options, settings);
  if (!command.parse(arguments)) return ExitStatus::done;

  std::vector<SweepPoint> points;
  std::string plan;
  for (Scene& scene : sweep_scenes(spec, axes)) {
    auto estimation = mc_estimation(scene, methods, seed_of(settings));
    const std::string name = "points/" + std::to_string(points.size());
    plan += name + ": " + estimation.plan + "\n";
    points.push_back({name, std::move(scene), std::move(estimation.job), nullptr});
  }
  const StopRule stop = stop_rule(settings);
  std::vector<PlannedRun> runs;
  for (const auto& point : points) {
    const std::string label =
        "point " + std::to_string(runs.size() + 1) + "/" + std::to_string(points.size());
    runs.push_back({point.name, label, point.job.batches, stop});
  }
  Session session(command.command_line(), settings, plan, std::move(runs),
                  inputs_text(points.front().scene));
  for (auto& point : points) point.sums = &session.state(point.name).sums;
  return session.run([&](ResultFile& file) {
    SweepTables tables;
    for (const auto& point : points) tables.add(point);
    print_ranges(points, tables);
    if (tables.few) note_few_steps();
    write_domain(file, points.front().scene);
    write_tables(file, axes, points, tables);
  });
}

}  // namespace flatspeckle::apps

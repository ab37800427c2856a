#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "apps/command/subcommands.h"
#include "apps/results/datasets.h"
#include "apps/results/estimation.h"
#include "apps/results/moments_table.h"
#include "core/error.h"
#include "core/result/result_group.h"
#include "core/session/identity.h"
#include "core/session/session.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/slab/refinement.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::apps {

const DatasetTable validate_table{
    .name = "validate",
    .rows = {{"entry", Data::numbers, "", "1", "number of the entry"},
             {"deviation", Data::real, "entry", "1",
              "|mc - reference| in combined standard errors, per entry in the order of the "
              "request"}},
    .attributes = {
        {"", "bias_allowance", "float64",
         "relative size of a difference without chance: what Monte Carlo neglects of exact "
         "solutions, or the tolerance of transport"}}};

namespace {

/// What the Monte Carlo method neglects, as a fraction: corrections of order 1/(k mean free path);
/// the shift of the wavenumber (refraction at the faces, local fields); and correlations, of order
/// the packing fraction where they are not taken in, of its square where they are (C16). As
/// data/bias_map.csv has it; a size, not a bound.
double bias_allowance(const Scene& scene) {
  const auto& medium = scene.medium;
  const double packing = medium.packing_fraction;
  return 2 / (scene.k * medium.mean_free_path()) + 2 * std::abs(medium.k_shift) / scene.k +
         (medium.structure.independent() ? packing : packing * packing);
}

/// Where a fixed number of points lacks a part of the covariance that Monte Carlo has (C12).
bool misses_forward_lobe(const Scene& scene) {
  const auto& request = scene.request;
  return scene.placement.kind == PlacementRule::Kind::poisson && scene.placement.count &&
         std::any_of(request.channels.begin(), request.channels.end(), [&](const Channel& channel) {
           const View& view = request.views[channel.view];
           const double q =
               scene.k * (std::sin(view.angle) - std::sin(request.lights[channel.light].angle));
           return !view.near && std::cos(view.angle) > 0 &&
                  std::abs(q) < 2 * std::numbers::pi / scene.domain.width;
         });
}

/// What Monte Carlo is held against: placements solved exactly, or a slab's transport.
struct Reference {
  std::string name;
  Estimation estimation;
  StopRule stop;
  double bias;
};

struct Comparison {
  std::string name;
  Estimate reference, mc;
  double bias = 0;

  /// Not below what rounding leaves.
  double error(std::size_t e) const {
    const double largest = std::max(std::abs(reference.value[e]), std::abs(mc.value[e]));
    return std::hypot(reference.error[e], mc.error[e], 1e-13 * largest);
  }
  double difference(std::size_t e) const { return std::abs(mc.value[e] - reference.value[e]); }
  double deviation(std::size_t e) const {
    return difference(e) == 0 ? 0 : difference(e) / error(e);
  }
  bool within_errors(std::size_t e) const { return deviation(e) <= 4; }
  bool within_bias(std::size_t e) const {
    return difference(e) <= bias * std::abs(reference.value[e]);
  }
};

void print_row(const CovarianceRequest& request, const Comparison& comparison, std::size_t e) {
  const auto [a, b] = request.entries[e];
  const double scale = std::max(std::abs(comparison.reference.value[e]), 1e-300);
  std::printf("%s %s  %21s %8.2g  %21s %8.2g  %6.1f %%  %5.1f%s\n",
              shown_channel(request, a).c_str(), shown_channel(request, b).c_str(),
              shown_value(comparison.mc.value[e]).c_str(), comparison.mc.error[e],
              shown_value(comparison.reference.value[e]).c_str(), comparison.reference.error[e],
              100 * comparison.difference(e) / scale, comparison.deviation(e),
              comparison.within_errors(e) ? ""
              : comparison.within_bias(e) ? "  within"
                                          : "  *");
}

void print_comparison(const Scene& scene, const Comparison& comparison) {
  const auto& request = scene.request;
  const std::size_t entries = shown_entries(request);
  std::printf("%-17s %-17s  %21s %8s  %21s %8s  %8s  %s\n", "light 1  view 1", "light 2  view 2",
              "mc", "error", comparison.name.c_str(), "error", "|diff|", "sigma");
  std::size_t in_errors = 0, in_bias = 0;
  for (std::size_t e = 0; e < entries; ++e) {
    if (e < most_rows) print_row(request, comparison, e);
    if (comparison.within_errors(e))
      ++in_errors;
    else if (comparison.within_bias(e))
      ++in_bias;
  }
  if (entries > most_rows) std::printf("... and %zu more\n", entries - most_rows);
  std::printf("%zu entries: %zu within 4 combined standard errors, ", entries, in_errors);
  if (comparison.name == "transport")
    std::printf("%zu more within its tolerance, ", in_bias);
  else if (comparison.bias > 0)
    std::printf(
        "%zu more within the %.1f %% that the\n"
        "method neglects at k mfp = %.1f, packing %.3f, k_shift / k = %.3f; ",
        in_bias, 100 * comparison.bias, scene.k * scene.medium.mean_free_path(),
        scene.medium.packing_fraction, scene.medium.k_shift / scene.k);
  std::printf("%zu beyond (*)\n", entries - in_errors - in_bias);
  if (misses_forward_lobe(scene))
    std::puts(
        "with a fixed count the exact covariance lacks the forward lobe's number fluctuation; "
        "give density instead");
}

void write_comparison(ResultFile& file, const Comparison& comparison) {
  const ResultGroup root(file, validate_table);
  std::vector<double> deviation;
  for (std::size_t e = 0; e < comparison.mc.value.size(); ++e)
    deviation.push_back(comparison.deviation(e));
  root.number("entry", deviation.size());
  root.put("deviation", deviation);
  root.attribute("bias_allowance", comparison.bias);
}

using Refer = std::function<Reference(const Scene&)>;

Refer by_waves(const Keys& keys, const MethodSettings& methods, const RunSettings& run,
               std::uint64_t seed) {
  const StopRule stop = stop_rule(keys, run, methods.wave_samples);
  return [stop, seed, tolerance = keys.read(methods.wave_tolerance)](const Scene& scene) {
    return Reference{"wave", wave_estimation(scene, tolerance, seed), stop, bias_allowance(scene)};
  };
}

Refer by_transport(const Keys& keys, MethodSettings& methods, const SceneSpec& spec,
                   const RunSettings& run, mc::ReversedPaths reversed) {
  read_transport(keys, methods, spec, run);
  return [reversed, tolerance = methods.tolerance](const Scene& scene) {
    return Reference{"transport", transport_estimation(scene, reversed, tolerance), both_batches(),
                     tolerance};
  };
}

}  // namespace

int validate(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings run;
  MethodSettings methods;
  Subcommand command(
      "validate",
      "Monte Carlo held against exact solutions, or in a slab against transport, entry by "
      "entry");
  Keys& keys = command.keys();
  add_keys(keys, spec);
  add_mc_keys(keys, methods);
  add_wave_keys(keys, methods);
  add_transport_keys(keys, methods);
  add_dimension_key(keys, spec);
  add_run_keys(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), keys, run, command.only_prints());
  const StopRule stop = stop_rule(keys, run);
  const auto reversed = reversed_paths(keys, methods);
  const auto refer = spec.domain == "slab" ? by_transport(keys, methods, spec, run, reversed)
                                           : by_waves(keys, methods, run, session.seed());
  if (spec.domain == "slab") keys.read(spec.dimension);
  const Scene scene = with_dimension(rounded_scene(keys, spec), spec);
  if (scene.medium.mu_s == 0)
    throw InputError("scatterer", spec.scatterer,
                     "this scene does not scatter, there is nothing to compare");
  refuse_absurd(methods, Neglected(scene));
  const auto chosen = refer(scene);
  const std::string& name = chosen.name;
  const Estimation& reference = chosen.estimation;
  const Estimation mc = mc_estimation(scene, reversed, session.seed());
  if (!command.settle()) return ExitStatus::done;
  return session.run(
      mc.plan + "\n" + reference.plan,
      {{"mc", "mc", mc.job.batches, stop}, {name, name, reference.job.batches, chosen.stop}},
      inputs_text(scene) + inputs_text(keys), [&](ResultFile& file) {
        const GroupedSums &mc_sums = session.sums("mc"), &reference_sums = session.sums(name);
        const FieldMoments mc_moments = field_moments(mc.job, mc_sums),
                           reference_moments = field_moments(reference.job, reference_sums);
        const Comparison comparison{name, reference_moments.covariance, mc_moments.covariance,
                                    chosen.bias};
        print_comparison(scene, comparison);
        write_medium(file, scene);
        write_axes(file, scene);
        print_ranges("mc",
                     mc::write_moments(file, "mc", mc.job, scene, mc_sums, mc_moments).ranges);
        print_ranges(name, mc::write_moments(file, name, reference.job, scene, reference_sums,
                                             reference_moments)
                               .ranges);
        if (name == "transport") mc::write_numerical(file, name);
        write_comparison(file, comparison);
      });
}

}  // namespace flatspeckle::apps

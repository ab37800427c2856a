#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "apps/command/subcommands.h"
#include "apps/results/comparison.h"
#include "apps/results/datasets.h"
#include "apps/results/extras.h"
#include "apps/results/moments_table.h"
#include "apps/results/tilt_search.h"
#include "core/error.h"
#include "core/result/result_group.h"
#include "core/session/identity.h"
#include "core/session/session.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/changes/frequency_shifts.h"
#include "mc/slab/refinement.h"
#include "mc/theory/allowance.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::apps {

const DatasetTable validate_table{
    .name = "validate",
    .rows = {{"entry", Data::numbers, "", "1", "number of the entry"},
             {"deviation", Data::real, "entry", "1",
              "|mc - reference| in combined standard errors, per entry in the order of the "
              "request"},
             {"frequency_deviation", Data::real, "frequency_shift LIGHT VIEW", "1",
              "the same of mc/frequency_correlation"},
             {"frequency_tilt_deviation", Data::real, "frequency_shift tilt", "1",
              "the same of mc/frequency_tilt_correlation"}},
    .attributes = {
        {"", "bias_allowance", "float64",
         "relative size of a difference without chance: what Monte Carlo neglects of exact "
         "solutions, or the tolerance of transport"}}};

namespace {

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
  ChangeEstimation estimation;
  StopRule stop;
  double bias;
};

RowNames entry_names(const CovarianceRequest& request) {
  return {"light 1  view 1   light 2  view 2  ", [&request](std::size_t e) {
            const auto [a, b] = request.entries[e];
            return shown_channel(request, a) + ' ' + shown_channel(request, b);
          }};
}

RowNames shift_names(const CovarianceRequest& request, const std::vector<double>& shifts) {
  return {request.has_reference() ? "tilt                   shift" : "light    view          shift",
          [&](std::size_t row) {
            const std::size_t count =
                request.has_reference() ? request.moves : request.channels.size();
            char shift[16];
            std::snprintf(shift, sizeof shift, " %10.4g", shifts[row / count]);
            return shown_change(request, row % count) + shift;
          }};
}

void print_allowance(const Scene& scene, std::size_t entries) {
  const mc::Allowance part(scene);
  std::printf(
      "%zu more within the %.1f %% that the method\n"
      "neglects (%.1f %% crossed paths: 2/(k mfp), k mfp = %.1f; %.1f %% refraction: 2 "
      "|k_shift|/k, k_shift/k = %.3f; %.1f %% for a box that guides; %.1f %% correlated positions, "
      "packing %.3f); ",
      entries, 100 * part.total(), 100 * part.crossed_paths,
      scene.k * scene.medium.mean_free_path(), 100 * part.k_shift, scene.medium.k_shift / scene.k,
      100 * part.guided, 100 * part.correlations, scene.medium.packing_fraction);
}

void print_agreement(const Scene& scene, const Comparison& comparison, const RowNames& names,
                     std::size_t values) {
  const auto [in_errors, in_bias] = print_comparison(comparison, values, names);
  std::printf("%zu %s: %zu within 4 combined standard errors, ", values,
              comparison.correlations ? "correlations" : "entries", in_errors);
  if (comparison.name == "transport")
    std::printf("%zu more within its tolerance, ", in_bias);
  else if (comparison.bias > 0)
    print_allowance(scene, in_bias);
  std::printf("%zu beyond (*)\n", values - in_errors - in_bias);
}

void print_entries(const Scene& scene, const Comparison& comparison) {
  print_agreement(scene, comparison, entry_names(scene.request), shown_entries(scene.request));
  if (misses_forward_lobe(scene))
    std::puts(
        "with a fixed count the exact covariance lacks the forward lobe's number fluctuation; "
        "give density instead");
}

void write_comparison(ResultFile& file, const Comparison& comparison) {
  const ResultGroup root(file, validate_table);
  const auto deviations = comparison.deviations();
  root.number("entry", deviations.size());
  root.put("deviation", deviations);
  root.attribute("bias_allowance", comparison.bias);
}

/// Both methods' correlations with shifted frequencies.
void compare_frequencies(ResultFile& file, const Scene& scene, const std::vector<double>& shifts,
                         const std::string& name, const mc::ChangeEstimates& mc,
                         const mc::ChangeEstimates& reference, double bias) {
  const Comparison comparison{name, reference.correlation, mc.correlation, bias, true};
  print_agreement(scene, comparison, shift_names(scene.request, shifts),
                  mc.correlation.value.size());
  mc::write_shift_axis(file, shifts);
  mc::write_frequency_shifts(file, "mc", scene, shifts, mc);
  mc::write_frequency_shifts(file, name, scene, shifts, reference);
  ResultGroup(file, validate_table)
      .put(scene.request.has_reference() ? "frequency_tilt_deviation" : "frequency_deviation",
           comparison.deviations());
}

using Shifts = std::vector<double>;
using Refer = std::function<Reference(const Scene&, const Shifts&)>;

ChangeEstimation without_change(const Estimation& estimation) {
  return {{estimation.job, {}, 0}, estimation.plan};
}

/// A budget of time is one of both methods: errors of a difference cost least where time goes as
/// the spread of a method's samples a second, and Monte Carlo's is a tenth of placements' or less.
constexpr double mc_share = 0.1;

StopRule with_share(StopRule stop, double share) {
  if (stop.seconds) *stop.seconds *= share;
  return stop;
}

Refer by_waves(const Keys& keys, const MethodSettings& methods, const RunSettings& run,
               std::uint64_t seed) {
  const StopRule stop = with_share(stop_rule(keys, run, methods.wave_samples), 1 - mc_share);
  return [stop, seed, tolerance = keys.read(methods.wave_tolerance)](const Scene& scene,
                                                                     const Shifts& shifts) {
    return Reference{"wave",
                     shifts.empty() ? without_change(wave_estimation(scene, tolerance, seed))
                                    : wave_frequencies(scene, shifts, tolerance, seed),
                     stop, mc::Allowance(scene).total()};
  };
}

Refer by_transport(const Keys& keys, MethodSettings& methods, const SceneSpec& spec,
                   const RunSettings& run, mc::ReversedPaths reversed) {
  read_transport(keys, methods, spec, run);
  return [reversed, tolerance = methods.tolerance](const Scene& scene, const Shifts& shifts) {
    return Reference{"transport",
                     shifts.empty()
                         ? without_change(transport_estimation(scene, reversed, tolerance))
                         : transport_frequencies(scene, reversed, shifts, tolerance),
                     both_batches(), tolerance};
  };
}

}  // namespace

int validate(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings run;
  MethodSettings methods;
  Shifts shifts;
  Subcommand command(
      "validate",
      "Monte Carlo held against exact solutions, or in a slab against transport, entry by "
      "entry");
  Keys& keys = command.keys();
  add_keys(keys, spec);
  std::vector<double> q_depths;
  add_q_depths_key(keys, q_depths);
  add_frequency_key(keys, shifts);
  add_mc_keys(keys, methods);
  add_wave_keys(keys, methods);
  add_transport_keys(keys, methods);
  add_dimension_key(keys, spec);
  add_run_keys(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), keys, run, command.only_prints());
  take_q_depths(keys, q_depths, spec);
  const bool slab = spec.domain == "slab";
  const StopRule stop = with_share(stop_rule(keys, run), slab ? 1 : mc_share);
  const auto reversed = reversed_paths(keys, methods);
  const auto refer = slab ? by_transport(keys, methods, spec, run, reversed)
                          : by_waves(keys, methods, run, session.seed());
  if (slab) keys.read(spec.dimension);
  keys.read(shifts);
  const Scene given = make_scene(keys, spec);
  note_rounding(given);
  const Scene scene = with_dimension(rounded_scene(given, spec), spec);
  if (scene.medium.mu_s == 0)
    throw InputError("scatterer", spec.scatterer,
                     "this scene does not scatter, there is nothing to compare");
  refuse_absurd(methods, Neglected(scene));
  const auto chosen = refer(scene, shifts);
  const std::string& name = chosen.name;
  const ChangeEstimation& reference = chosen.estimation;
  const ChangeEstimation mc = shifts.empty()
                                  ? without_change(mc_estimation(scene, reversed, session.seed()))
                                  : mc_frequencies(scene, reversed, shifts, session.seed());
  if (!command.settle()) return ExitStatus::done;
  return session.run(
      mc.plan + "\n" + reference.plan,
      {{"mc", "mc", mc.job.field.batches, stop},
       {name, name, reference.job.field.batches, chosen.stop}},
      inputs_text(scene) + inputs_text(keys), [&](ResultFile& file) {
        const GroupedSums &mc_sums = session.sums("mc"), &reference_sums = session.sums(name);
        const FieldMoments mc_moments = field_moments(mc.job.field, mc_sums),
                           reference_moments = field_moments(reference.job.field, reference_sums);
        const Comparison comparison{name, reference_moments.covariance, mc_moments.covariance,
                                    chosen.bias};
        print_entries(scene, comparison);
        write_medium(file, scene);
        write_axes(file, scene);
        print_ranges("mc", mc::write_moments(file, "mc", mc.job.field, scene, mc_sums, mc_moments));
        print_ranges(name, mc::write_moments(file, name, reference.job.field, scene, reference_sums,
                                             reference_moments));
        if (name == "transport") mc::write_numerical(file, name);
        write_comparison(file, comparison);
        if (shifts.empty()) return;
        compare_frequencies(
            file, scene, shifts, name, mc::change_estimates(scene.request, mc.job, mc_sums),
            mc::change_estimates(scene.request, reference.job, reference_sums), chosen.bias);
      });
}

}  // namespace flatspeckle::apps

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command/subcommands.h"
#include "apps/flatland/own_places.h"
#include "apps/results/datasets.h"
#include "apps/results/extras.h"
#include "apps/results/moments_table.h"
#include "apps/results/tilt_search.h"
#include "apps/results/view_power.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/statistics.h"
#include "core/result/result_group.h"
#include "core/session/session.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/paths/estimators/reflection_theory.h"
#include "mc/slab/refinement.h"
#include "mc/theory/allowance.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::apps {

namespace {

/// Comparison of Monte Carlo with a reference method, value by value.
struct Comparison {
  std::string name;  ///< name of the reference method
  Estimate reference, mc;
  double bias = 0;  ///< relative systematic difference that is allowed
  /// True if `bias` is relative to 1 instead of the value, as for correlations.
  bool correlations = false;
  /// 1 for each value that is not expected to agree, for a known reason; empty if there are none.
  std::vector<std::uint64_t> apart = {};
  /// Magnitude below which `bias` is relative to this magnitude instead of the value.
  double least_scale = 0;

  /// Returns the combined standard error of both methods, but at least the rounding error.
  double error(std::size_t e) const {
    const double largest = std::max(std::abs(reference.value[e]), std::abs(mc.value[e]));
    return std::hypot(reference.error[e], mc.error[e], 1e-13 * largest);
  }

  double difference(std::size_t e) const { return std::abs(mc.value[e] - reference.value[e]); }

  /// Returns the difference of the methods in units of the combined standard error.
  double deviation(std::size_t e) const {
    return difference(e) == 0 ? 0 : difference(e) / error(e);
  }

  std::vector<double> deviations() const {
    std::vector<double> all;
    for (std::size_t e = 0; e < mc.value.size(); ++e) all.push_back(deviation(e));
    return all;
  }

  bool is_apart(std::size_t e) const { return !apart.empty() && apart[e] != 0; }
  bool within_errors(std::size_t e) const { return deviation(e) <= 4; }
  bool within_bias(std::size_t e) const { return difference(e) <= bias * scale(e); }
  /// Returns the magnitude to which `bias` is relative.
  double scale(std::size_t e) const {
    return correlations ? 1 : std::max(least_scale, std::abs(reference.value[e]));
  }

  /// Summary of all values except those marked in `apart`: RMS difference and RMS combined error,
  /// both relative to the RMS of the reference, and fraction of the values that agree within errors
  /// or bias. whole() returns nullopt if all values are marked.
  struct Whole {
    double difference, error, share_within;
  };
  std::optional<Whole> whole() const {
    double differences = 0, errors = 0, references = 0;
    std::size_t entries = 0, within = 0;
    for (std::size_t e = 0; e < mc.value.size(); ++e) {
      if (is_apart(e)) continue;
      differences += std::norm(mc.value[e] - reference.value[e]);
      errors += error(e) * error(e);
      references += std::norm(reference.value[e]);
      within += within_errors(e) || within_bias(e) ? 1 : 0;
      ++entries;
    }
    if (entries == 0 || references == 0) return std::nullopt;
    return Whole{std::sqrt(differences / references), std::sqrt(errors / references),
                 static_cast<double>(within) / static_cast<double>(entries)};
  }
};

/// First columns of the printed table of a comparison: their heading, and their text for each row.
struct RowNames {
  std::string head;
  std::function<std::string(std::size_t)> of;
};

/// Numbers of values that agree within errors, that agree only within the bias, and that are not
/// expected to agree.
struct Agreement {
  std::size_t in_errors = 0, in_bias = 0, apart = 0;
};

void print_row(const Comparison& comparison, std::size_t e, const RowNames& names) {
  const double scale = std::max(comparison.scale(e), 1e-300);
  std::printf("%s  %21s %8.2g  %21s %8.2g  %6.1f %%  %5.1f%s\n", names.of(e).c_str(),
              shown_value(comparison.mc.value[e]).c_str(), comparison.mc.error[e],
              shown_value(comparison.reference.value[e]).c_str(), comparison.reference.error[e],
              100 * comparison.difference(e) / scale, comparison.deviation(e),
              comparison.is_apart(e)        ? "  forward"
              : comparison.within_errors(e) ? ""
              : comparison.within_bias(e)   ? "  within"
                                            : "  *");
}

/// Prints the comparison as a table, and counts how many of its values agree.
Agreement print_comparison(const Comparison& comparison, std::size_t values,
                           const RowNames& names) {
  std::printf("%s  %21s %8s  %21s %8s  %8s  %s\n", names.head.c_str(), "mc", "error",
              comparison.name.c_str(), "error", "|diff|", "sigma");
  Agreement agreement;
  for (std::size_t e = 0; e < values; ++e) {
    if (e < most_rows) print_row(comparison, e, names);
    if (comparison.is_apart(e))
      ++agreement.apart;
    else if (comparison.within_errors(e))
      ++agreement.in_errors;
    else if (comparison.within_bias(e))
      ++agreement.in_bias;
  }
  if (values > most_rows) std::printf("... and %zu more\n", values - most_rows);
  return agreement;
}

}  // namespace

const DatasetTable validate_table{
    .name = "validate",
    .rows =
        {{"entry", Data::numbers, "", "1", "number of the entry"},
         {"deviation", Data::real, "entry", "1",
          "|mc - reference| in combined standard errors, per entry in the order of the request"},
         {"forward", Data::count, "entry", "1",
          "for boxes with a fixed number of scatterers; 1: both channels lie in the forward lobe, "
          "where the exact covariance lacks a term that Monte Carlo includes (conventions, C12)"},
         {"rms_difference", Data::estimate, "", "1",
          "RMS of mc - reference over the RMS of the reference, of all entries except forward "
          "ones; absent if all are forward; its error is the part due to combined standard errors"},
         {"share_within", Data::real, "", "1",
          "fraction of the entries of rms_difference that agree within 4 combined standard errors "
          "or bias_allowance"},
         {"frequency_deviation", Data::real, "frequency_shift LIGHT VIEW", "1",
          "|mc - reference| of frequency_correlation in combined standard errors"},
         {"frequency_tilt_deviation", Data::real, "frequency_shift tilt", "1",
          "|mc - reference| of frequency_tilt_correlation in combined standard errors"}},
    .attributes = {{"", "bias_allowance", "float64",
                    "relative systematic difference allowed: effects neglected by Monte Carlo, or "
                    "the tolerance of transport"}}};

namespace {

/// Reference method with which Monte Carlo is compared: exact solutions of many placements, or
/// transport through a slab.
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

/// Returns a text with the contributions to mc::Allowance that do not round to 0.0 %.
std::string allowance_text(const Scene& scene) {
  const mc::Allowance part(scene);
  const double packing = scene.medium.packing_fraction;
  std::string text;
  const auto add = [&](double share, const char* what, double because) {
    char words[96];
    std::snprintf(words, sizeof words, "%s%.1f %% %s %.3g", text.empty() ? "" : "; ", 100 * share,
                  what, because);
    if (share >= 5e-4) text += words;
  };
  add(part.crossed_paths,
      "crossed paths: 2/(k mfp), k mfp =", scene.k * scene.medium.mean_free_path());
  add(part.k_shift, "refraction: 2 |k_shift|/k, k_shift/k =", scene.medium.k_shift / scene.k);
  add(part.faces,
      "interference of waves that the faces reflect, k depth =", scene.k * scene.domain.depth);
  add(part.guided, "guiding by the box, depth / width =", scene.domain.depth / scene.domain.width);
  add(part.correlations, "correlated positions, packing", packing);
  add(part.fixed_number, "fixed number of scatterers,", scene.placement.mean_count);
  return text;
}

void print_agreement(const Scene& scene, const Comparison& comparison, const RowNames& names,
                     std::size_t values) {
  const auto [in_errors, in_bias, apart] = print_comparison(comparison, values, names);
  std::printf("%zu %s: %zu within 4 combined standard errors, ", values,
              comparison.correlations ? "correlations" : "entries", in_errors);
  if (comparison.name == "transport")
    std::printf("%zu more within the tolerance of transport, ", in_bias);
  else if (comparison.bias > 0)
    std::printf(
        "%zu more within %.1f %%, the estimated size\nof effects that Monte Carlo neglects (%s); ",
        in_bias, 100 * comparison.bias, allowance_text(scene).c_str());
  if (apart > 0) std::printf("%zu forward, ", apart);
  std::printf("%zu beyond (*)\n", values - in_errors - in_bias - apart);
  if (apart > 0)
    std::printf(
        "forward: within 1/width of the light's direction, where a fixed number of scatterers "
        "removes a\nfluctuation of the coherent field that Monte Carlo includes (conventions, "
        "C12)%s\n",
        scene.scatterer.is_disk() ? "" : "; density instead of count includes it in both");
  if (const auto whole = comparison.whole())
    std::printf(
        "all entries%s: RMS difference %.3g %% of the RMS value, combined errors %.3g %%; %.4g %% "
        "of the entries agree\n",
        apart > 0 ? " except forward" : "", 100 * whole->difference, 100 * whole->error,
        100 * whole->share_within);
}

std::vector<std::uint64_t> forward_entries(const Scene& scene) {
  return column(scene.request.entries, [&](const Entry& entry) {
    return std::uint64_t{mc::lacks_fluctuation(scene, entry)};
  });
}

/// Returns the mean intensity of the entries that are intensities and not in the forward lobe, by
/// the reference method. In space the deviations of Monte Carlo were measured relative to this
/// mean, because weak views deviate more.
double mean_intensity(const CovarianceRequest& request, const Comparison& comparison) {
  double sum = 0, count = 0;
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    if (request.entries[e].a != request.entries[e].b || comparison.is_apart(e)) continue;
    sum += comparison.reference.value[e].real();
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

void write_comparison(ResultFile& file, const Comparison& comparison) {
  const ResultGroup root(file, validate_table);
  const auto deviations = comparison.deviations();
  root.number("entry", deviations.size());
  root.put("deviation", deviations);
  if (!comparison.apart.empty()) root.put("forward", std::span(comparison.apart));
  if (const auto whole = comparison.whole()) {
    root.put("rms_difference", whole->difference, whole->error);
    root.put("share_within", whole->share_within);
  }
  root.attribute("bias_allowance", comparison.bias);
}

/// Compares the field correlations after frequency shifts from both methods, and writes them.
void compare_frequencies(ResultFile& file, const Scene& scene, const mc::FrequencyShifts& shifts,
                         const std::string& name, const mc::ChangeEstimates& mc,
                         const mc::ChangeEstimates& reference, double bias) {
  const Comparison comparison{name, reference.correlation, mc.correlation, bias, true};
  print_agreement(scene, comparison, shift_names(scene.request, shifts.relative),
                  mc.correlation.value.size());
  mc::write_shift_axis(file, shifts);
  mc::write_frequency_shifts(file, "mc", scene, shifts.relative, mc);
  mc::write_frequency_shifts(file, name, scene, shifts.relative, reference);
  ResultGroup(file, validate_table)
      .put(scene.request.has_reference() ? "frequency_tilt_deviation" : "frequency_deviation",
           comparison.deviations());
}

using Shifts = std::vector<double>;  // relative to the frequency
using Refer = std::function<Reference(const Scene&, const Shifts&)>;

ChangeEstimation without_change(const Estimation& estimation) {
  return {{estimation.job, {}, 0}, estimation.plan};
}

/// Fraction of the time limit that Monte Carlo uses. The error of the difference is smallest if the
/// run times of the methods are in proportion to their standard errors after one second. That of
/// Monte Carlo is at most 1/10 of that of exact solutions.
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
                     both_batches(tolerance), tolerance};
  };
}

struct ValidateKeys {
  SceneSpec spec;
  RunSettings run;
  MethodSettings methods;
  std::vector<std::string> frequency_shifts;
  std::vector<double> q_depths;
};

void add_keys(Keys& keys, ValidateKeys& values) {
  add_keys(keys, values.spec);
  add_places_key(keys, values.spec);
  add_q_depths_key(keys, values.q_depths);
  add_frequency_key(keys, values.frequency_shifts);
  add_mc_keys(keys, values.methods);
  add_wave_keys(keys, values.methods);
  add_transport_keys(keys, values.methods);
  add_run_keys(keys, values.run);
}

int compare_methods(const Subcommand& command, ValidateKeys& values) {
  auto& [spec, run, methods, shift_texts, q_depths] = values;
  const Keys& keys = command.keys();
  Session session(command.text(), keys, run, command.only_prints());
  take_q_depths(keys, q_depths, spec);
  keys.read(spec.dimension);
  const bool slab = spec.domain == "slab";
  const StopRule stop = with_share(stop_rule(keys, run), slab ? 1 : mc_share);
  const auto reversed = reversed_paths(keys, methods);
  if (has_own_places(spec)) {
    const OwnPlaces places(keys, spec, methods);
    return command.settle() ? places.compare(session, reversed, stop_rule(keys, run))
                            : ExitStatus::done;
  }
  const auto refer = slab ? by_transport(keys, methods, spec, run, reversed)
                          : by_waves(keys, methods, run, session.seed());
  const mc::FrequencyShifts all_shifts = frequency_shifts(keys, shift_texts, spec);
  const Shifts& shifts = all_shifts.relative;
  const Scene given = make_scene(keys, spec);
  note_rounding(given);
  const Scene scene = with_dimension(rounded_scene(given, spec), spec);
  if (scene.medium.mu_s == 0)
    throw InputError("scatterer", spec.scatterer,
                     "does not scatter in this scene: a comparison requires scattering");
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
      inputs_text(scene) + inputs_text(keys) +
          (all_shifts.optical ? number_text(*all_shifts.optical) + '\n' : ""),
      [&, &methods = methods](ResultFile& file) {
        const GroupedSums &mc_sums = session.sums("mc"), &reference_sums = session.sums(name);
        const FieldMoments mc_moments = field_moments(mc.job.field, mc_sums),
                           reference_moments = field_moments(reference.job.field, reference_sums);
        Comparison comparison{name, reference_moments.covariance, mc_moments.covariance,
                              chosen.bias};
        if (name == "wave") comparison.apart = forward_entries(scene);
        if (scene.medium.dimension == 3 && name == "wave")
          comparison.least_scale = mean_intensity(scene.request, comparison);
        print_agreement(scene, comparison, entry_names(scene.request),
                        shown_entries(scene.request));
        print_errors(scene.request, mc_moments.covariance);
        write_medium(file, scene);
        write_axes(file, scene);
        print_ranges("mc", mc::write_moments(file, "mc", mc.job.field, scene, mc_sums, mc_moments));
        print_ranges(name, mc::write_moments(file, name, reference.job.field, scene, reference_sums,
                                             reference_moments));
        if (name == "transport") mc::write_numerical(file, name);
        check_power(file, "mc", scene, {"mc", mc_sums.total_samples(), 0, session.seed()});
        check_power(file, name, scene, {name, 0, methods.tolerance_of(name), session.seed()});
        mc::write_reflection_theory(file, scene);
        write_comparison(file, comparison);
        if (shifts.empty()) return;
        compare_frequencies(
            file, scene, all_shifts, name, mc::change_estimates(scene.request, mc.job, mc_sums),
            mc::change_estimates(scene.request, reference.job, reference_sums), chosen.bias);
      });
}

}  // namespace

std::unique_ptr<Call> validate(const std::string&) {
  return call_with<ValidateKeys>(
      "validate",
      "Compares Monte Carlo with exact solutions, or in a slab with transport, entry by entry",
      compare_methods);
}

}  // namespace flatspeckle::apps

#include "apps/results/extras.h"

#include <algorithm>
#include <cstdio>

#include "apps/command/command_line.h"
#include "apps/results/moments_table.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "flatland/scene/frequency_shift.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/dynamics/frequency_shifts.h"
#include "mc/paths/layers/layer_gradient.h"
#include "mc/slab/slab_jobs.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::apps {

namespace {

void refuse_layers(const Scene& scene, const std::string& key) {
  if (scene.profile)
    throw InputError("method", "transport",
                     "does not support " + key + " with layers: use method = mc");
}

void require_plane_waves(const std::string& key, const CovarianceRequest& request) {
  using Kind = CovarianceRequest::Kind;
  if (!request.lights.all(Light::Kind::plane) || request.kind == Kind::tilt_shift)
    throw InputError(key + ": requires plane waves and a covariance other than tilt_shift");
}

Estimation with_gradient(const Scene& scene, const mc::GradientJob& job, const std::string& plan) {
  std::string text = plan + "; derivatives by";
  for (const auto& parameter : job.parameters) text += ' ' + parameter;
  return {job.field, text, [scene, job](ResultFile& file, const GroupedSums& sums) {
            const auto gradient = mc::gradient_estimates(scene, sums, job);
            print_gradient(scene.request, job, gradient);
            mc::write_gradient(file, scene.request, job, gradient);
          }};
}

Estimation mc_gradient(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t seed) {
  require_plane_waves("gradient", scene.request);
  const auto plan = mc::gradient_plan(scene, reversed);
  const auto job = scene.profile ? mc::layer_gradient_job(scene, plan, seed)
                                 : mc::gradient_job(scene, plan, seed);
  return with_gradient(scene, job, "mc: " + plan.describe());
}

Estimation transport_gradient(const Scene& scene, mc::ReversedPaths reversed, double tolerance) {
  refuse_layers(scene, "gradient");
  mc::check_gradient(scene);
  const bool with_reversed = mc::make_plan(scene, reversed).reversed;
  return with_gradient(scene, mc::slab_gradient_job(scene, with_reversed, {tolerance}),
                       transport_estimation(scene, reversed, tolerance).plan);
}

/// Prints the changes at which a squared correlation falls to a level, for each channel.
void print_crossings(const CovarianceRequest& request, const mc::Crossings& crossings, double scale,
                     const std::string& name, const std::string& unit) {
  if (crossings.few_steps)
    std::fprintf(stderr,
                 "note: a %s is interpolated with fewer than four points below it; its error "
                 "excludes the interpolation error: add points\n",
                 name.c_str());
  for (std::size_t c = 0; c < std::min(crossings.censored.size(), most_rows); ++c) {
    const mc::Range range{crossings.value.value[c].real() * scale,
                          static_cast<mc::Range::Censoring>(crossings.censored[c])};
    std::printf("%s %s: %s%s\n", shown_channel(request, static_cast<std::uint32_t>(c)).c_str(),
                name.c_str(), range_text(range, crossings.value.error[c] * scale).c_str(),
                unit.c_str());
  }
}

void print_delays(const Scene& scene, const mc::Dynamics& dynamics,
                  const mc::DelayEstimates& found) {
  const bool in_seconds = dynamics.diffusion.has_value();
  print_changes(scene.request, in_seconds ? "delay (s)" : "delay", dynamics.delays,
                found.changes.correlation);
  if (in_seconds)
    std::printf("diffusion constant %.4g m^2/s, k^2 D = %.4g/s%s\n", *dynamics.diffusion,
                dynamics.motion.diffusion,
                scene.faces && scene.profile ? " (k in vacuum)" : "");
  if (!scene.request.has_reference())
    print_crossings(scene.request, found.decay, 1, "decay time (|g1| = 1/e)",
                    in_seconds ? " s" : "");
}

Estimation with_delays(const Scene& scene, const mc::PathJob& job, const mc::Dynamics& dynamics,
                       const std::string& plan) {
  const std::string moves = dynamics.motion.only_diffuses(scene) ? "diffuse" : "diffuse and flow";
  return {job.field, plan + "; scatterers " + moves,
          [scene, job, dynamics](ResultFile& file, const GroupedSums& sums) {
            const auto found = mc::delay_estimates(scene.request, job, sums, dynamics);
            print_delays(scene, dynamics, found);
            mc::write_delays(file, scene, dynamics, found);
            const mc::Exposure& exposure = dynamics.exposure;
            if (exposure.times.empty()) return;
            const auto contrast =
                mc::squared_contrast(scene.request, job, sums, dynamics.delays, exposure);
            print_changes(scene.request, dynamics.diffusion ? "exposure (s)" : "exposure",
                          exposure.times, contrast, "K^2");
            mc::write_contrast(file, exposure, contrast);
          }};
}

Estimation mc_delays(const Scene& scene, mc::ReversedPaths reversed, const mc::Dynamics& dynamics,
                     std::uint64_t seed) {
  require_plane_waves("delays", scene.request);
  mc::check_exposure(dynamics.exposure, dynamics.delays);
  const auto plan = mc::make_plan(scene, reversed);
  return with_delays(scene, mc::delay_job(scene, plan, dynamics.delays, seed, dynamics.motion),
                     dynamics, "mc: " + plan.describe());
}

mc::PathJob change_job(const Scene& scene, mc::ReversedPaths reversed,
                       const std::vector<mc::FieldChange>& changes, double tolerance) {
  const bool with_reversed = mc::make_plan(scene, reversed).reversed;
  return mc::slab_change_job(scene, with_reversed, {tolerance}, changes);
}

Estimation transport_delays(const Scene& scene, mc::ReversedPaths reversed,
                            const mc::Dynamics& dynamics, double tolerance) {
  mc::check_delays(scene, dynamics.delays, dynamics.motion);
  require_changing("delays", scene.request);
  const mc::Motion& motion = dynamics.motion;
  if (motion.velocity != Vec{} || motion.shear != 0)
    throw InputError("velocity, shear: require method = mc");
  if (scene.request.has_reference() && !dynamics.exposure.times.empty())
    throw InputError("exposures: require covariance = intensity");
  mc::check_exposure(dynamics.exposure, dynamics.delays);
  std::vector<mc::FieldChange> changes;
  for (const double delay : dynamics.delays) changes.push_back({.delay = motion.diffusion * delay});
  return with_delays(scene, change_job(scene, reversed, changes, tolerance), dynamics,
                     transport_estimation(scene, reversed, tolerance).plan);
}

/// Prints and writes the contrasts of sources that are not monochromatic.
void report_sources(ResultFile& file, const CovarianceRequest& request, const mc::PathJob& job,
                    const GroupedSums& sums, const mc::FrequencyShifts& shifts,
                    const std::vector<mc::SourceLine>& lines) {
  constexpr double much = 0.01;
  const auto found = mc::source_contrast(request, job, sums, shifts.relative, lines);
  if (found.truncation > much)
    std::fprintf(
        stderr,
        "note: frequency_shifts end before C_I has fallen, which leaves up to %.2g %% of a "
        "squared source contrast uncertain: add larger shifts\n",
        100 * found.truncation);
  std::vector<double> widths;
  for (const mc::SourceLine& line : lines) widths.push_back(shifts.shown(line.width()));
  print_changes(request, shifts.optical ? "width (Hz)" : "linewidth", widths, found.squares, "C^2");
  mc::write_source_contrast(file, shifts, lines, found.squares);
}

Estimation with_frequency_shifts(const Scene& scene, const Extras& extras,
                                 const ChangeEstimation& changes) {
  return {changes.job.field, changes.plan + "; two frequencies",
          [scene, changes, shifts = extras.shifts, lines = extras.lines](ResultFile& file,
                                                                         const GroupedSums& sums) {
            const CovarianceRequest& request = scene.request;
            const auto found = mc::change_estimates(request, changes.job, sums);
            std::vector<double> shown;
            for (const double shift : shifts.relative) shown.push_back(shifts.shown(shift));
            print_changes(request, shifts.optical ? "shift (Hz)" : "shift", shown,
                          found.correlation);
            mc::write_shift_axis(file, shifts);
            mc::write_frequency_shifts(file, "", scene, shifts.relative, found);
            if (request.has_reference()) return;
            const auto widths = mc::crossings(request, changes.job, sums, shifts.relative, 0.5);
            print_crossings(request, widths, shifts.shown(1), "half width (C_I = 1/2)",
                            shifts.optical ? " Hz" : "");
            mc::write_half_widths(file, shifts, widths);
            if (!lines.empty()) report_sources(file, request, changes.job, sums, shifts, lines);
          }};
}

}  // namespace

std::optional<double> length_unit(const Keys& keys) {
  const Key* const key = keys.find("length_unit");
  return key != nullptr && !key->value().empty() ? read_number(key->value().front()) : std::nullopt;
}

void add_frequency_key(Keys& keys, std::vector<std::string>& shifts) {
  keys.group("Methods");
  keys.add("frequency_shifts", shifts,
           "Also estimate the correlation of the field with the field at shifted frequencies: "
           "numbers relative to the frequency; or, if medium_index and length_unit are given, "
           "frequencies such as 0:50GHz:26, changes of the vacuum wavelength (0.1nm) or of the "
           "wavenumber (0.5/cm)");
}

void add_extra_keys(Keys& keys, Extras& extras) {
  add_length_unit_key(keys, extras.length_unit);
  keys.group("Methods");
  keys.add(
          "gradient", extras.gradient,
          "Also estimate derivatives of the covariance with respect to mu_t, g, albedo and optical "
          "depth; with transport, for cylinders and spheres, also with respect to radius and index")
      .only_of("method = mc or transport");
  add_keys(keys, extras.moving);
  add_frequency_key(keys, extras.frequency_shifts);
  add_keys(keys, extras.source);
}

mc::FrequencyShifts frequency_shifts(const Keys& keys, const std::vector<std::string>& texts,
                                     const SceneSpec& spec) {
  const auto optical = optical_frequency(spec, length_unit(keys));
  return {relative_frequencies("frequency_shifts", keys.read(texts), optical, FrequencyKind::shift),
          optical};
}

std::string Extras::identity() const {
  if (!dynamics.diffusion && !shifts.optical) return "";
  return number_text(dynamics.motion.diffusion) + ' ' + number_text(shifts.optical.value_or(0)) +
         '\n';
}

void read_extras(const Keys& keys, Extras& extras, const SceneSpec& spec,
                 const std::string& method) {
  keys.read(extras.length_unit);
  extras.shifts = frequency_shifts(keys, extras.frequency_shifts, spec);
  const bool shifts = !extras.shifts.relative.empty();
  if (shifts && spec.covariance == "intensity")
    extras.lines = mc::source_lines(keys, extras.source, extras.shifts.optical);
  if (method == "wave") return;
  extras.dynamics = mc::make_dynamics(keys, extras.moving, spec, length_unit(keys));
  const bool delays = !extras.dynamics.delays.empty(), gradient = keys.read(extras.gradient);
  if (gradient && delays) throw InputError("gradient, delays: give only one of them");
  if (shifts && (gradient || delays))
    throw InputError("gradient, delays, frequency_shifts: give only one of them");
}

ChangeEstimation mc_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                const std::vector<double>& shifts, std::uint64_t seed) {
  check_frequency_shifts(scene.request, shifts);
  const auto plan = mc::frequency_plan(scene, reversed);
  return {mc::frequency_job(scene, plan, shifts, seed), "mc: " + plan.describe()};
}

ChangeEstimation transport_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                       const std::vector<double>& shifts, double tolerance) {
  refuse_layers(scene, "frequency_shifts");
  check_frequency_shifts(scene.request, shifts);
  std::vector<mc::FieldChange> changes;
  for (const double shift : shifts) changes.push_back({.shift = shift});
  return {change_job(scene, reversed, changes, tolerance),
          transport_estimation(scene, reversed, tolerance).plan};
}

ChangeEstimation wave_frequencies(const Scene& scene, const std::vector<double>& shifts,
                                  double tolerance, std::uint64_t seed) {
  check_frequency_shifts(scene.request, shifts);
  const auto [field, all] = wave::frequency_job(scene, shifts, seed, tolerance);
  return {{field, all, scene.request.entries.size()}, wave_plan(scene, tolerance)};
}

Estimation extended_estimation(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                               std::uint64_t seed) {
  if (extras.gradient) return mc_gradient(scene, reversed, seed);
  if (!extras.dynamics.delays.empty()) return mc_delays(scene, reversed, extras.dynamics, seed);
  if (const auto& shifts = extras.shifts.relative; !shifts.empty())
    return with_frequency_shifts(scene, extras, mc_frequencies(scene, reversed, shifts, seed));
  return mc_estimation(scene, reversed, seed);
}

Estimation extended_transport(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                              double tolerance) {
  if (extras.gradient) return transport_gradient(scene, reversed, tolerance);
  if (!extras.dynamics.delays.empty())
    return transport_delays(scene, reversed, extras.dynamics, tolerance);
  if (const auto& shifts = extras.shifts.relative; !shifts.empty())
    return with_frequency_shifts(scene, extras,
                                 transport_frequencies(scene, reversed, shifts, tolerance));
  return transport_estimation(scene, reversed, tolerance);
}

Estimation extended_waves(const Scene& scene, const Extras& extras, double tolerance,
                          std::uint64_t seed) {
  if (const auto& shifts = extras.shifts.relative; !shifts.empty())
    return with_frequency_shifts(scene, extras, wave_frequencies(scene, shifts, tolerance, seed));
  return wave_estimation(scene, tolerance, seed);
}

}  // namespace flatspeckle::apps

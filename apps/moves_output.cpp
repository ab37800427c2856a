#include "apps/moves_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "mc/theory/diffusion.h"
#include "mc/theory/tilt_shift.h"

namespace flatspeckle::apps {

namespace {

using Kind = CovarianceRequest::Kind;

void write_range(MomentsGroup& group, const std::string& name, const mc::RangeEstimate& estimate,
                 double scale, const std::string& units, const std::string& long_name) {
  group.write<double>(name, {estimate.range.value * scale}, {estimate.error * scale}, {}, units,
                      long_name);
  group.attribute(name, "censored", static_cast<std::uint64_t>(estimate.range.censored));
  const std::string shown =
      range_text({estimate.range.value * scale, estimate.range.censored}, estimate.error * scale);
  std::printf("%s%s: %s\n", group.prefix().c_str(), long_name.c_str(), shown.c_str());
}

/// Entries of the moves on a grid of steps, from move `first` on.
void write_entries(MomentsGroup& group, const CovarianceRequest& request,
                   const Estimate& covariance, const std::string& prefix, std::size_t first,
                   std::size_t moves, Axes axes) {
  const std::size_t views = request.reference_views;
  axes.emplace_back(view_axis(request));
  group.covariance(prefix + "covariance",
                   part(covariance, request.tilted_entry(first, 0), moves * views), axes,
                   "covariance of reference and moved field");
  const bool tilts = request.kind == Kind::memory_effect;
  group.intensity(prefix + (tilts ? "tilted_intensity" : "moved_intensity"),
                  part(covariance, request.tilted_intensity(first, 0), moves * views), axes,
                  "variance of the moved field");
}

/// Tilts with matched views, or translations: one curve.
void write_curve(MomentsGroup& group, const FieldJob& job, const Scene& scene,
                 const GroupedSums& sums, const Estimate& covariance) {
  const auto& request = scene.request;
  const bool tilts = request.kind == Kind::memory_effect;
  const Axes axes = {tilts ? "tilt" : "shift"};
  write_entries(group, request, covariance, "", 0, request.moves, axes);
  const auto effect = mc::memory_effect(request, sums, job.covariance);
  group.write("field_correlation", effect.correlation, effect.correlation_error, axes, "1",
              "field correlation C_E, summed over views");
  const mc::RangeEstimate range{effect.range, effect.range_error};
  if (few_steps(tilts ? request.tilt_q : request.shifts, effect.range)) note_few_steps();
  if (tilts)
    write_range(group, "memory_effect_range", range, scene.domain.depth, "1",
                "q L at C_I = 1/2, L the depth");
  else
    write_range(group, "translation_range", range, 1, "length", "translation at C_I = 1/2");
}

/// Diffusion theory where it holds, in transmission, and single scattering, both for matched views
/// of plane waves.
void write_theory(MomentsGroup& group, const Scene& scene) {
  const auto& request = scene.request;
  if (!request.lights.all(Light::Kind::plane)) return;
  std::vector<double> views, diffusion, single;
  for (std::size_t v = 0; v < request.reference_views; ++v) views.push_back(request.views[v].angle);
  const double depth = scene.domain.depth;
  for (double q : request.tilt_q) {
    diffusion.push_back(mc::diffusion_field_correlation(scene.medium, depth, q));
    single.push_back(
        mc::single_scattering_correlation(request.lights.front().angle, views, depth, q));
  }
  if (std::all_of(views.begin(), views.end(), [](double view) { return std::cos(view) > 0; }))
    group.write("diffusion_theory", diffusion, {"tilt"}, "1",
                "C_E of matched views in diffusion theory of a slab");
  group.write("single_scattering", single, {"tilt"}, "1",
              "C_E of matched views by single scattering in a slab without attenuation");
}

void write_map(MomentsGroup& group, const FieldJob& job, const Scene& scene,
               const GroupedSums& sums, const Estimate& covariance) {
  const auto& request = scene.request;
  const std::size_t tilts = request.tilts.size(), map = tilts * request.shifts.size();
  const Axes grid = {"tilt", "shift"};
  const double depth = scene.domain.depth;
  const bool far = !request.views.front().near;
  write_entries(group, request, covariance, "", 0, map, grid);
  const auto found = mc::tilt_shift(request, sums, job.covariance);
  group.write("field_correlation", found.correlation, found.correlation_error, grid, "1",
              "field correlation C_E, summed over views");
  write_range(group, "tilt_range", found.along_tilts, depth, "1",
              "q L at C_I = 1/2 where the views stay, L the depth");
  write_range(group, "shift_range", found.along_shifts, far ? depth : 1, far ? "1" : "length",
              far ? "shift x L at C_I = 1/2 where the light stays, L the depth"
                  : "shift at C_I = 1/2 where the light stays");
  if (!far) return;
  write_entries(group, request, covariance, "matched_", map, tilts, {"tilt"});
  group.write("matched_correlation", found.matched, found.matched_error, {"tilt"}, "1",
              "field correlation C_E with matched views, summed over views");
  write_range(group, "memory_effect_range", found.along_matched, depth, "1",
              "q L at C_I = 1/2 with matched views, L the depth");
  write_theory(group, scene);
}

}  // namespace

void write_moves(MomentsGroup& group, const FieldJob& job, const Scene& scene,
                 const GroupedSums& sums, const Estimate& covariance) {
  const auto& request = scene.request;
  group.intensity("reference_intensity",
                  part(covariance, request.reference_intensity(0), request.reference_views),
                  {view_axis(request)}, "variance of the reference field");
  (request.kind == Kind::tilt_shift ? write_map : write_curve)(group, job, scene, sums, covariance);
}

}  // namespace flatspeckle::apps

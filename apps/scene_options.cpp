#include "apps/scene_options.h"

#include <limits>
#include <sstream>

#include "core/error.h"

namespace flatspeckle::apps {

void add_scatterer_options(Options& options, SceneSpec& spec) {
  options.add_with_default("--wavelength", spec.wavelength, "Wavelength; sets the unit of length");
  options.add_with_default("--scatterer", spec.scatterer,
                           "point, soft, hard, tm, te or hg (bulk only)");
  options.add("--radius", spec.radius, "Radius of soft, hard, tm and te");
  options.add("--index", spec.index, "Relative index of tm and te, as \"1.5+0.1i\" (default 1.5)");
  options.add("--phase_shift", spec.phase_shift,
              "Scattering phase shift of a lossless point (default pi/2, resonance)");
}

void add_bulk_options(Options& options, SceneSpec& spec) {
  options.add("--g", spec.g, "Mean cosine of hg (default 0)");
  options.add("--albedo", spec.albedo, "Albedo of hg and of resonant points (default 1)");
  options.add("--optical_depth", spec.optical_depth, "Density from mu_t x depth");
}

void add_medium_options(Options& options, SceneSpec& spec) {
  options.add_with_default("--domain", spec.domain, "box or slab (infinite in x)");
  options.add("--width", spec.width, "Width of the box, |x| <= width/2");
  options.add("--depth", spec.depth, "Depth, 0 <= z <= depth");
  options.add("--count", spec.count, "Density from a fixed number of scatterers in the box");
  options.add("--density", spec.density, "Density as number per area");
  options.add("--mean_free_path", spec.mean_free_path, "Density from the mean free path 1/mu_t");
  options.add("--placement", spec.placement, "poisson (points), hard_disk or equilibrium (disks)");
  options.add("--min_gap", spec.min_gap,
              "Least distance between the rims of disks (default 1e-3 radius)");
}

void add_structure_option(Options& options, SceneSpec& spec) {
  options.add_with_default(
      "--structure", spec.structure,
      "Structure factor of disks in Monte Carlo: none, hard_disks, or a file that "
      "place --structure wrote");
}

void add_view_options(Options& options, SceneSpec& spec) {
  // Their defaults stay out of the resolved scene: near sensors and pairs take their place.
  options.add("--light_angles", spec.light_angles,
              "Directions of the plane waves, radians from +z (default 0)");
  options.add("--view_angles", spec.view_angles,
              "Directions of the far-field views, radians from +z (default 0)");
  options.add("--near_sensors", spec.near_sensors, "CSV with columns x, z: near-field sensors");
}

void add_request_options(Options& options, SceneSpec& spec) {
  options.add_with_default("--covariance", spec.covariance,
                           "intensity, pairs, memory_effect, tilt_shift, translation or full");
  options.add("--tilts", spec.tilts, "memory_effect, tilt_shift: rotations of the light, radians");
  options.add("--shifts", spec.shifts,
              "tilt_shift: of the views, in k sin(view) (radians per length) or of near sensors "
              "along x; translation: of light and near sensors along x");
  options.add("--pairs", spec.pairs,
              "pairs: light 1, view 1, light 2, view 2 (radians) of each pair in turn");
}

void add_light_options(Options& options, SceneSpec& spec) {
  options.add("--near_sources", spec.near_sources,
              "CSV with columns x, z: point sources in place of plane waves");
  options.add("--beam_waist", spec.beam_waist,
              "Gaussian beams in place of plane waves: 1/e radius of the field at the focus");
  options.add("--beam_positions", spec.beam_positions,
              "x of the beams' focus, each with every light angle (default 0)");
  options.add("--beam_depth", spec.beam_depth, "z of the beams' focus (default 0)");
}

void settle_views(const Subcommand& subcommand, SceneSpec& spec) {
  if (!spec.near_sensors.empty() && !subcommand.given("view_angles")) spec.view_angles.clear();
}

void settle_request(const Subcommand& subcommand, SceneSpec& spec) {
  if (spec.covariance == "pairs") {
    for (const char* key :
         {"light_angles", "view_angles", "near_sensors", "near_sources", "beam_waist"})
      if (subcommand.given(key))
        throw InputError(std::string(key) +
                         ": covariance = pairs names the angles itself; leave it out");
  }
  if (!spec.near_sources.empty() && subcommand.given("light_angles"))
    throw InputError("near_sources", spec.near_sources, "give either near_sources or light_angles");
  settle_views(subcommand, spec);
  const bool both = !spec.near_sensors.empty() && !spec.view_angles.empty();
  if (both && spec.covariance != "memory_effect")  // which has no near sensors at all
    throw InputError("near_sensors", spec.near_sensors, "give either near_sensors or view_angles");
}

std::string sensors_text(const CovarianceRequest& request) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (const View& view : request.views)
    if (view.near) text << view.point.x << ',' << view.point.z << '\n';
  for (const Light& light : request.lights)
    if (light.kind == Light::Kind::point)
      text << "source " << light.point.x << ',' << light.point.z << '\n';
  return text.str();
}

std::string inputs_text(const Scene& scene) {
  return sensors_text(scene.request) + scene.medium.structure.text();
}

}  // namespace flatspeckle::apps

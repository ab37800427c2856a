// Slabs without chance, in the plane and in space, as thin, deep and peaked as they come.

#include <cmath>

#include "bench/stability/extreme_rows.h"
#include "bench/stability/mc_extremes.h"
#include "bench/stability/mc_extremes_fit.h"
#include "grin/media/scattering/phase_function.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/adding/space_scene.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_flux.h"

namespace flatspeckle::bench {

namespace {

using mc::ReversedPaths;

/// Without absorption.
Finding lossless_in_plane(const Bulk& bulk) {
  const Scene scene = hg_slab(bulk, intensity_request({0}, {far_view(0)}));
  const auto shares = mc::slab_flux(scene, 0, {1e-6}).value;
  const Complex left = shares[mc::reflected] + shares[mc::transmitted];
  return {std::abs(left + std::expm1(-bulk.optical_depth)), 1e-9};
}

double lost_in_space(const Scene& scene, double optical_depth) {
  const auto shares = mc::slab_flux(scene, 0, {1e-6}).value;
  return std::abs(shares[mc::reflected] + shares[mc::transmitted] + std::expm1(-optical_depth));
}

Finding lossless_in_space(const Bulk& bulk) {
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = bulk.g;
  const Scene scene = mc::in_space(hg_slab(bulk, intensity_request({0}, {far_view(0)})), spec);
  return {lost_in_space(scene, bulk.optical_depth), 1e-9};
}

/// Intensities of Monte Carlo, in errors.
Finding by_paths(const Bulk& bulk, double view, std::uint64_t paths) {
  const Scene scene = hg_slab(bulk, intensity_request({0}, {far_view(view)}));
  const auto exact = mc::slab_covariance(scene, false, {1e-4}).value;
  const Estimate found = covariance(scene, ReversedPaths::no, paths);
  return in_errors(found.value[0], found.error[0], exact[0], 0.1, 1e-4);
}

Finding by_paths_in_space(const Bulk& bulk, double view, std::uint64_t paths) {
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = bulk.g;
  const Scene scene = mc::in_space(hg_slab(bulk, intensity_request({0}, {far_view(view)})), spec);
  const auto exact = mc::slab_covariance(scene, false, {1e-3}).value;
  const Estimate found = covariance(scene, ReversedPaths::no, paths);
  return in_errors(found.value[0], found.error[0], exact[0], 0.1, 1e-3);
}

/// Spheres, without absorption.
Finding lossless_spheres(double optical_depth, double radius) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.dimension = 3;
  spec.depth = 1000;
  spec.optical_depth = optical_depth;
  spec.scatterer = "mie";
  spec.radius = radius;
  spec.index = "1.33";
  return {lost_in_space(mc::in_space(make_scene(spec), spec), optical_depth), 1e-9};
}

/// Frequencies that differ by nothing to speak of, over the intensity; values are complex then.
Finding same_frequencies(const Bulk& bulk, int dimension) {
  Scene scene = hg_slab(bulk, intensity_request({0}, {far_view(0)}));
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = bulk.g;
  if (dimension == 3) scene = mc::in_space(scene, spec);
  const auto solve = [&](double shift) {
    return mc::slab_covariance(scene, false, {1e-6}, {.shift = shift}).value[0];
  };
  const Complex intensity = solve(0);
  return {std::abs(solve(1e-18) / intensity - 1.0), 1e-5};
}

}  // namespace

std::vector<ExtremeCase> mc_transport_extremes() {
  ExtremeRows rows("mc");
  const std::string energy = "reflected + transmitted = scattered", errors = "paths, in errors";
  for (const Bulk& bulk : {Bulk{1e-3}, Bulk{1e4}, Bulk{5, 0.99}}) {
    const std::string name =
        "OD " + short_number(bulk.optical_depth) + ", g " + short_number(bulk.g);
    rows.add("transport, " + name, energy, [=] { return lossless_in_plane(bulk); });
    rows.add("transport in space, " + name, energy, [=] { return lossless_in_space(bulk); });
  }
  for (const Bulk& bulk : {Bulk{1e-3, 0.5}, Bulk{30, 0, 0.8}}) {
    const std::string name =
        "OD " + short_number(bulk.optical_depth) + ", albedo " + short_number(bulk.albedo);
    rows.add("transport, " + name, errors, [=] { return by_paths(bulk, 0.3, 20000); });
    rows.add("transport in space, " + name, errors,
             [=] { return by_paths_in_space(bulk, 0.3, 20000); });
  }
  for (const double optical_depth : {1e-3, 1e4})
    for (const double radius : {1e-3, 1.0})
      rows.add("transport, spheres, OD " + short_number(optical_depth) + ", radius " +
                   short_number(radius),
               energy, [=] { return lossless_spheres(optical_depth, radius); });
  for (const Bulk& bulk : {Bulk{1e-3}, Bulk{1e4}, Bulk{300, 0, 0.9}})
    for (const int dimension : {2, 3})
      rows.add("transport, two frequencies, OD " + short_number(bulk.optical_depth) + ", albedo " +
                   short_number(bulk.albedo) + (dimension == 3 ? ", in space" : ""),
               "shift 1e-18 = none", [=] { return same_frequencies(bulk, dimension); });
  add_fits(rows);
  return std::move(rows).rows();
}

}  // namespace flatspeckle::bench

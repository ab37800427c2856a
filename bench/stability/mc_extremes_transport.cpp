// Deterministic transport through extremely thin, deep and forward-scattering slabs, in 2D and 3D;
// fits of media to synthetic curves of the same media.

#include <cmath>

#include "bench/scenes/synthetic_slab.h"
#include "bench/stability/extreme_rows.h"
#include "bench/stability/mc_extremes.h"
#include "mc/distance/distance_job.h"
#include "mc/distance/flow_plan.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_flux.h"

namespace flatspeckle::bench {

namespace {

using mc::ReversedPaths;

Scene viewed_slab(const Bulk& bulk, double view, int dimension) {
  const Scene slab = hg_slab(bulk, intensity_request({0}, {far_view(view)}));
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = bulk.g;
  return dimension == 3 ? mc::in_space(slab, spec) : slab;
}

/// Checks that, without absorption, reflected plus transmitted power equals the scattered power.
Finding lossless_scene(const Scene& scene, double optical_depth) {
  const auto shares = mc::slab_flux(scene, 0, {1e-6}).value;
  const Complex left = shares[mc::reflected] + shares[mc::transmitted];
  return {std::abs(left + std::expm1(-optical_depth)), 1e-9};
}

Finding lossless_transport(const Bulk& bulk, int dimension) {
  return lossless_scene(viewed_slab(bulk, 0, dimension), bulk.optical_depth);
}

/// Checks conservation of power for oblique illumination of a medium whose forward peak the
/// ordinates alone do not resolve.
Finding lossless_peak(const Bulk& bulk, int dimension) {
  constexpr double incidence = 1.2;
  Scene scene = viewed_slab(bulk, 0, dimension);
  scene.request = intensity_request({incidence}, {far_view(0)});
  return lossless_scene(scene, bulk.optical_depth / std::cos(incidence));
}

/// Compares intensities with Monte Carlo, in standard errors.
Finding by_paths(const Bulk& bulk, int dimension) {
  const Scene scene = viewed_slab(bulk, 0.3, dimension);
  const double tolerance = dimension == 3 ? 1e-3 : 1e-4;
  return in_errors(covariance(scene, ReversedPaths::no, 20000),
                   mc::slab_covariance(scene, false, {tolerance}).value, 0.1, tolerance);
}

/// Returns a slab behind faces, lit and seen at an angle outside.
Scene faced(const Bulk& bulk, double index, double incidence, int dimension) {
  Scene scene = viewed_slab(bulk, 0, dimension);
  scene.faces = Faces{index, 1};
  scene.request = intensity_request({incidence}, {far_view(incidence)});
  return scene;
}

/// Checks conservation of power for a slab without absorption behind faces.
Finding lossless_faces(const Bulk& bulk, double index, double incidence, int dimension) {
  const Scene scene = faced(bulk, index, incidence, dimension);
  const auto shares = mc::slab_flux(scene, 0, {1e-6}).value;
  const Complex left = shares[mc::reflected] + shares[mc::transmitted];
  return {std::abs(left + mc::unscattered_shares(scene).front() - 1.0), 1e-9};
}

/// Compares the intensity behind faces with Monte Carlo, in standard errors.
Finding faces_by_paths(const Bulk& bulk, double index, double incidence, int dimension) {
  const Scene scene = faced(bulk, index, incidence, dimension);
  const double tolerance = dimension == 3 ? 1e-3 : 1e-4;
  return in_errors(covariance(scene, ReversedPaths::no, 20000),
                   mc::slab_covariance(scene, false, {tolerance}).value, 0.1, tolerance);
}

/// Checks conservation of power for spheres without absorption.
Finding lossless_spheres(double optical_depth, double radius) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.dimension = 3;
  spec.depth = 1000;
  spec.optical_depth = optical_depth;
  spec.scatterer = "mie";
  spec.radius = radius;
  spec.index = "1.33";
  return lossless_scene(mc::in_space(make_scene(spec), spec), optical_depth);
}

/// Checks that the covariance at two nearly equal frequencies equals the intensity. With a
/// frequency shift all values are complex.
Finding same_frequencies(const Bulk& bulk, int dimension) {
  const Scene scene = viewed_slab(bulk, 0, dimension);
  const auto solve = [&](double shift) {
    return mc::slab_covariance(scene, false, {1e-6}, {.shift = shift}).value[0];
  };
  return {std::abs(solve(1e-18) / solve(0) - 1.0), 1e-5};
}

struct Truth {
  double g, albedo, optical_depth;
};

/// Returns the largest deviation of the fitted parameters, in units of `errors`.
Finding misfit(const mc::MediumFit& fit, const Eigen::VectorXd& truth,
               const Eigen::VectorXd& errors, double limit) {
  const Eigen::VectorXd in_errors = (fit.estimates - truth).cwiseQuotient(errors);
  return {fit.converged ? in_errors.cwiseAbs().maxCoeff() : 1e9, limit};
}

/// Fits exact curves. The deviation is in units of the standard errors for 1 % noise.
Finding found_again(const Truth& truth, const std::vector<std::string>& free) {
  constexpr double depth = 20000;  // reversed paths are negligible
  SyntheticSlab slab(depth, truth.g, truth.albedo, truth.optical_depth);
  for (const double view : {0.2, std::numbers::pi - 0.6}) slab.add_curve(view, {1, 2, 4, 8});
  slab.add_transmittance();
  const mc::MediumFit fit = mc::fit_medium(slab_task(slab.exact(), free));
  return misfit(fit, Eigen::VectorXd{{truth.g, truth.albedo, truth.optical_depth}}, fit.errors,
                0.2);
}

/// Fits only g, by Monte Carlo. The deviation is in units of the standard error of the fitted
/// g.
Finding found_by_paths(const Truth& truth) {
  SyntheticSlab slab(2000, truth.g, truth.albedo, truth.optical_depth);
  for (const double view : {0.3, std::numbers::pi - 0.6}) slab.add_curve(view, {1, 2, 4, 8});
  mc::FitTask task = slab_task(slab.exact(), {"g=-0.5:0.99"}, [&](mc::MovingSpec& scene) {
    scene.albedo = truth.albedo;
    scene.optical_depth = truth.optical_depth;
  });
  task.paths.emplace();
  const mc::MediumFit fit = mc::fit_medium(task);
  return misfit(fit, Eigen::VectorXd{{truth.g}}, fit.by_sampling.diagonal().cwiseSqrt(), 4);
}

/// Fits the diffusion coefficient to a decay in a known medium.
Finding diffusion_again(double optical_depth, const std::vector<double>& delays) {
  SyntheticSlab slab(2000, 0.8, 1, optical_depth);
  slab.add_decay(0.2, delays);
  const auto known = [=](mc::MovingSpec& scene) {
    scene.g = 0.8;
    scene.optical_depth = optical_depth;
  };
  const mc::MediumFit fit =
      mc::fit_medium(slab_task(slab.exact(), {"diffusion=0.001:1000"}, known));
  return misfit(fit, Eigen::VectorXd{{1.0}}, fit.errors, 0.2);
}

/// Compares powers on rings at 3 to 100 transport mean free paths from a beam by the radiance and
/// by the adjoint radiance.
Finding far_powers(const Bulk& bulk, double index) {
  Scene scene = viewed_slab(bulk, 0, 3);
  if (index != 1) scene.faces = Faces{index, 1, Polarisation::unpolarised};
  const double transport = bulk.depth / (bulk.optical_depth * (1 - bulk.g * bulk.albedo));
  mc::DistanceRequest request;
  for (const double distance : {3.0, 30.0, 100.0})
    request.detectors.push_back(
        {mc::DistanceDetector::Kind::ring, distance * transport, transport});
  constexpr double tolerance = 2e-3;
  double worst = 0;
  for (const Invariant& check : mc::reciprocity(scene, request, tolerance))
    worst = larger(worst, check.off);
  return {worst, tolerance};
}

void add_far_powers(ExtremeRows& rows) {
  for (const Bulk& bulk : {Bulk{1e4, 0.9, 0.99}, Bulk{1e4, 0.99, 0.999}, Bulk{1e6, 0.9, 1 - 1e-6}})
    for (const double index : {1.0, 3.0})
      rows.add("reflectance far from a beam, OD " + short_number(bulk.optical_depth) + ", albedo " +
                   short_number(bulk.albedo) + ", index " + short_number(index),
               "power = that by the adjoint, relative", far_powers, bulk, index);
}

/// Photons detected per second and pixel, read noise, and decays of g1 per second.
struct ExtremeCamera {
  double rate, read_noise, decay;
};

/// Checks that nine times as many pixels have three times the signal-to-noise ratio of the flow.
Finding many_pixels(const ExtremeCamera& camera) {
  mc::DistanceRequest request;
  request.detectors.push_back({mc::DistanceDetector::Kind::disk, 10, 1});
  request.dynamics.exposure.times = {1e-3, 1e-2};
  mc::DistanceEstimates found;
  found.power.value = {camera.rate};
  for (double delay = 1e-6; delay < 0.02; delay *= 2) {
    const double g1 = std::exp(-camera.decay * delay);
    request.dynamics.delays.push_back(delay);
    found.correlation.value.emplace_back(g1);
    found.correlation_gradient.value.emplace_back(-camera.decay * delay * g1);
  }
  const std::vector<Complex> derivatives = found.correlation_gradient.value;
  for (int other = 1; other < mc::layer_coefficients; ++other)
    found.correlation_gradient.value.insert(found.correlation_gradient.value.end(),
                                            derivatives.begin(), derivatives.end());
  mc::Instrument instrument{.photons = 1, .modes = request.detectors[0].area(), .density = 1};
  instrument.read_noise = camera.read_noise;
  instrument.flow = {1};
  instrument.others = {0};
  const mc::FlowPlan one = mc::flow_plan(instrument, request, found);
  instrument.count *= 9;
  const mc::FlowPlan nine = mc::flow_plan(instrument, request, found);
  double worst = 0;
  for (std::size_t e = 0; e < one.contrast_ratio.size(); ++e)
    worst = larger(worst, std::abs(nine.contrast_ratio[e] - 3 * one.contrast_ratio[e]) /
                              (1e-300 + nine.contrast_ratio[e]));
  worst = larger(worst, std::abs(nine.correlation_ratio[0] - 3 * one.correlation_ratio[0]) /
                            (1e-300 + nine.correlation_ratio[0]));
  return {worst, 1e-9};
}

void add_cameras(ExtremeRows& rows) {
  for (const ExtremeCamera& camera :
       {ExtremeCamera{1e-30, 0, 100}, ExtremeCamera{1e-30, 1e9, 100}, ExtremeCamera{1e5, 1e9, 100},
        ExtremeCamera{1e30, 0, 100}, ExtremeCamera{1e5, 2, 1e9}, ExtremeCamera{1e5, 2, 0}})
    rows.add("flow from " + short_number(camera.rate) + " photons a second, read noise " +
                 short_number(camera.read_noise) + ", decay " + short_number(camera.decay),
             "flow / error by pixels^(1/2)", many_pixels, camera);
}

void add_faces(ExtremeRows& rows) {
  for (const double index : {0.5, 1.0001, 1.33, 4.0})
    for (const double incidence : {0.0, 1.56}) {
      if (std::sin(incidence) > index) continue;  // totally reflected
      for (const int dimension : {2, 3})
        for (const Bulk& bulk : {Bulk{1e-3, 0}, Bulk{10, 0.9}, Bulk{1e3, 0}}) {
          const std::string name =
              "faces, index " + short_number(index) + ", light at " + short_number(incidence) +
              ", OD " + short_number(bulk.optical_depth) + (dimension == 3 ? ", in space" : "");
          rows.add("transport, " + name, "all shares of power = 1", lossless_faces, bulk, index,
                   incidence, dimension);
          // Paths of light that grazes the faces inside are undersampled, also without faces.
          const bool grazes = std::sin(incidence) > 0.99 * index;
          if (bulk.optical_depth == 10 && !grazes)
            rows.add("paths, " + name, "paths, in errors", faces_by_paths, bulk, index, incidence,
                     dimension);
        }
    }
}

void add_fits(ExtremeRows& rows) {
  const auto add = [&](const std::string& name, const Truth& truth,
                       const std::vector<std::string>& free) {
    rows.add_slow("fit of a slab, " + name,
                  "parameters of exact curves, in standard errors of 1 % noise", found_again, truth,
                  free);
  };
  const std::string albedo = "albedo=0.8:1";
  add("OD 0.1, g 0.9", {0.9, 0.95, 0.1}, {"g=0.3:0.98", albedo, "optical_depth=0.01:3"});
  add("OD 15, g 0.95", {0.95, 0.99, 15}, {"g=0.3:0.99", albedo, "optical_depth=1:60"});
  add("OD 10, g 0", {0, 0.9, 10}, {"g=-0.5:0.9", albedo, "optical_depth=1:60"});
  const auto add_paths = [&](const std::string& name, const Truth& truth) {
    rows.add_slow("fit by paths, " + name, "g of exact curves, in statistical standard errors",
                  found_by_paths, truth);
  };
  add_paths("OD 0.05, g 0.9", {0.9, 0.95, 0.05});
  add_paths("OD 20, g 0.95", {0.95, 0.99, 20});
  add_paths("OD 10, albedo 1e-3", {0.3, 1e-3, 10});
  const auto add_diffusion = [&](const std::string& name, double optical_depth,
                                 const std::vector<double>& delays) {
    rows.add_slow("fit of a decay, " + name, "diffusion, in standard errors of 1 % noise",
                  diffusion_again, optical_depth, delays);
  };
  add_diffusion("OD 0.01, single scattering", 0.01, {1, 5, 20});
  add_diffusion("OD 60, most of it gone", 60, {1e-4, 1e-3, 1e-2});
  add("albedo 1, its bound", {0.7, 1, 5}, {"g=0.3:0.98", albedo, "optical_depth=1:60"});
}

}  // namespace

void mc_transport_extremes(ExtremeRows& rows) {
  const std::string energy = "reflected + transmitted = scattered", errors = "paths, in errors";
  const auto both = [&](const std::string& what, const std::string& invariant, const auto& check,
                        const Bulk& bulk) {
    rows.add("transport, " + what, invariant, check, bulk, 2);
    rows.add("transport in space, " + what, invariant, check, bulk, 3);
  };
  for (const Bulk& bulk : {Bulk{1e-3}, Bulk{1e4}, Bulk{5, 0.99}})
    both("OD " + short_number(bulk.optical_depth) + ", g " + short_number(bulk.g), energy,
         lossless_transport, bulk);
  for (const double rest : {1e-3, 1e-6, 1e-9})
    both("OD 1, 1 - g " + short_number(rest) + ", light at 1.2", energy, lossless_peak,
         Bulk{1, 1 - rest});
  for (const Bulk& bulk : {Bulk{1e-3, 0.5}, Bulk{30, 0, 0.8}})
    both("OD " + short_number(bulk.optical_depth) + ", albedo " + short_number(bulk.albedo), errors,
         by_paths, bulk);
  for (const double optical_depth : {1e-3, 1e4})
    for (const double radius : {1e-3, 1.0})
      rows.add("transport, spheres, OD " + short_number(optical_depth) + ", radius " +
                   short_number(radius),
               energy, lossless_spheres, optical_depth, radius);
  for (const Bulk& bulk : {Bulk{1e-3}, Bulk{1e4}, Bulk{300, 0, 0.9}})
    for (const int dimension : {2, 3})
      rows.add("transport, two frequencies, OD " + short_number(bulk.optical_depth) + ", albedo " +
                   short_number(bulk.albedo) + (dimension == 3 ? ", in space" : ""),
               "shift 1e-18 = none", same_frequencies, bulk, dimension);
  add_faces(rows);
  add_far_powers(rows);
  add_cameras(rows);
  add_fits(rows);
}

}  // namespace flatspeckle::bench

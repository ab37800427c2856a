// Paths in extremely thin, deep, absorbing, forward-scattering and obliquely illuminated slabs.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <memory>
#include <numbers>
#include <string_view>

#include <boost/math/quadrature/gauss.hpp>

#include "bench/oracles/discrete_ordinates.h"
#include "bench/oracles/slab_theory.h"
#include "bench/stability/extreme_rows.h"
#include "bench/stability/mc_extremes.h"
#include "flatland/media/layers.h"
#include "mc/paths/estimators/flux.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::bench {

namespace {

using mc::ReversedPaths;
using std::numbers::pi;

/// Returns the slab divided into equal layers.
Scene in_layers(Scene slab, std::size_t layers) {
  const double thickness = slab.domain.depth / static_cast<double>(layers);
  slab.profile =
      std::make_shared<const Layers>(std::vector<Material>(layers, {slab.scatterer, slab.medium}),
                                     std::vector<double>(layers, thickness));
  return slab;
}

/// Compares every intensity with the integral equation of isotropic slabs, accurate to 1e-3.
Finding isotropic_slab(const Bulk& bulk, const std::vector<double>& lights,
                       const std::vector<double>& views, ReversedPaths reversed,
                       std::uint64_t paths, std::size_t layers) {
  const auto request = intensity_request(lights, far_views(views));
  const Scene slab = hg_slab(bulk, request);
  const Estimate found = covariance(layers == 1 ? slab : in_layers(slab, layers), reversed, paths);
  const oracles::IsotropicSlab theory(k, bulk.depth, bulk.optical_depth / bulk.depth, bulk.albedo);
  std::vector<Complex> expected;
  for (const auto [light, view] : request.channels) {
    const oracles::IsotropicSlab::Channel channel{lights[light], views[view]};
    expected.push_back(reversed == ReversedPaths::yes ? theory.with_reversed(channel, channel)
                                                      : theory.without_reversed(channel, channel));
  }
  return in_errors(found, expected, 0.1, 1e-3);
}

/// Checks that the scattered power over all directions equals the loss of the beam. Directions are
/// dense about the lobes at 0 and pi.
Finding scattered_power(double g, double optical_depth) {
  using Rule = boost::math::quadrature::gauss<double, 10>;
  std::vector<double> views, weights;
  const double edges[] = {0, 0.001, 0.002, 0.006, 0.01, 0.05, 0.3, pi / 2};
  for (const double lobe : {0.0, pi})
    for (int e = 0; e < 7; ++e)
      for (const double side : {-1.0, 1.0})
        for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
          for (const double node : {-Rule::abscissa()[i], Rule::abscissa()[i]}) {
            const double half = (edges[e + 1] - edges[e]) / 2;
            views.push_back(lobe + side * (edges[e] + half * (1 + node)));
            weights.push_back(half * Rule::weights()[i]);
          }
  const Scene scene = hg_slab({optical_depth, g}, intensity_request({0}, far_views(views)));
  const FieldJob job = mc::covariance_job(scene, mc::make_plan(scene, ReversedPaths::no), 7);
  const Estimate power =
      jackknife(summed(job.batches, 16000), [&](double samples, std::span<const Complex> sums) {
        const auto values = job.covariance(samples, sums);
        Complex total = 0;
        for (std::size_t v = 0; v < values.size(); ++v) total += weights[v] * values[v];
        return std::vector<Complex>{total};
      });
  const double expected = -std::expm1(-optical_depth);
  // the quadrature over the lobe is accurate to 2e-3
  return in_errors(power.value[0], power.error[0], expected, 0.02, 2e-3);
}

/// Compares the covariance of tilted fields at k L = 1e6, q L = 0 .. 2, with the integral equation.
Finding tilted_fields() {
  const Bulk bulk{5, 0, 1, 1e6 / k};
  std::vector<double> tilts;
  for (const double ql : {0.0, 0.5, 2.0}) tilts.push_back(std::asin(ql / 1e6));
  const auto request = memory_effect_request(k, 0, {0.1}, tilts);
  const Estimate found = covariance(hg_slab(bulk, request), ReversedPaths::no, 40000);
  const oracles::IsotropicSlab theory(k, bulk.depth, bulk.optical_depth / bulk.depth, 1);
  const auto channel = [&](std::size_t number) -> oracles::IsotropicSlab::Channel {
    const Channel c = request.channels[number];
    return {request.lights[c.light].angle, request.views[c.view].angle};
  };
  std::vector<Complex> expected;
  for (const auto [a, b] : request.entries)
    expected.push_back(theory.without_reversed(channel(a), channel(b)));
  return in_errors(found, expected, 0.1, 1e-3);
}

/// Checks that the correlation at tilt 0 is exactly 1, with error 0.
Finding untilted() {
  const auto request = memory_effect_request(k, 1.5, {0.1, 1.55}, {0.0, 1e-7});
  const Scene scene = hg_slab({3, 0.9, 0.99, 1e6 / k}, request);
  const FieldJob job = mc::covariance_job(scene, mc::make_plan(scene, ReversedPaths::automatic), 1);
  const auto effect = mc::memory_effect(request, summed(job.batches, 4000), job.covariance);
  return {larger(std::abs(effect.correlation[0] - 1), effect.correlation_error[0]), 1e-12};
}

/// Checks illumination and detection along an infinite slab, at exactly pi/2. As cos(pi/2) is 6e-17
/// in floating point, the power is of that order.
Finding along() {
  const auto request = intensity_request({0, 1.5}, far_views({pi / 2, -pi / 2}));
  double sum = 0;
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no})
    sum += total_magnitude(covariance(hg_slab({2}, request), reversed, 4000));
  const auto grazing = intensity_request({pi / 2}, far_views({0.1, pi}));
  return {sum + total_magnitude(covariance(hg_slab({2}, grazing), ReversedPaths::no, 4000)), 1e-16};
}

Finding black() {
  const auto request = memory_effect_request(k, 0, {0.1, pi}, {0.0, 0.01});
  return {total_magnitude(covariance(hg_slab({2, 0, 0}, request), ReversedPaths::yes, 4000)), 0};
}

/// Checks that intensities without reversed paths do not depend on the wavelength, by comparing k L
/// = 63 with 6e6.
Finding wavelength() {
  const auto request = intensity_request({0, -0.7}, far_views({0.1, 1.5, pi}));
  Scene scene = hg_slab({2.5, 0.5}, request);
  const Estimate long_waves = covariance(scene, ReversedPaths::no, 4000);
  scene.wavelength *= 1e-5;
  scene.k *= 1e5;
  const Estimate short_waves = covariance(scene, ReversedPaths::no, 4000);
  double worst = 0;
  for (std::size_t e = 0; e < request.entries.size(); ++e)
    worst = larger(worst, std::abs(short_waves.value[e] / long_waves.value[e] - 1.0));
  return {worst, 1e-12};
}

struct Flux {
  mc::FluxEstimates shares;
  Estimate total;  ///< sum of all fractions, for each illumination
};
Flux flux_of(const Scene& scene, std::uint64_t paths) {
  const mc::FluxJob job = mc::flux_job(scene, 1, 1);
  const GroupedSums sums = summed(job.batches, paths);
  return {mc::flux_estimates(job, sums),
          jackknife(sums, [](double samples, std::span<const Complex> all) {
            return std::vector<Complex>{(all[0] + all[1] + all[2] + all[3]) / samples};
          })};
}

Flux flux(const Bulk& bulk, std::uint64_t paths) {
  return flux_of(hg_slab(bulk, intensity_request({0}, far_views({0}))), paths);
}

/// Checks that without absorption every walk conserves power.
Finding lossless_flux(const Bulk& bulk, std::uint64_t paths) {
  const double scattered = -std::expm1(-bulk.optical_depth);
  return {std::abs(flux(bulk, paths).total.value[0] / scattered - 1.0), 1e-10};
}

/// Compares the fractions of power with a solution by discrete ordinates, `nodes` per quadrant.
Finding crossing(const mc::FluxEstimates& shares, const Bulk& bulk,
                 const std::function<double(double)>& phase, int nodes) {
  const oracles::SlabTransport theory({bulk.optical_depth, bulk.albedo, phase}, {0}, nodes);
  return worse(in_errors(shares.transmittance.value[0], shares.transmittance.error[0],
                         theory.transmittance(0), 0.05, 1e-4),
               in_errors(shares.reflectance.value[0], shares.reflectance.error[0],
                         theory.reflectance(0), 0.05, 1e-4));
}

Finding one_peak(const Bulk& bulk, std::uint64_t paths) {
  return crossing(flux(bulk, paths).shares, bulk, oracles::henyey_greenstein(bulk.g), 50);
}

SceneSpec bulk_slab(const std::string& scatterer, const Bulk& bulk) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = bulk.depth;
  spec.scatterer = scatterer;
  spec.albedo = bulk.albedo;
  spec.optical_depth = bulk.optical_depth;
  return spec;
}

/// Checks a phase function with a forward and a backward peak.
Finding two_peaks(double g, const Bulk& bulk, std::uint64_t paths) {
  SceneSpec spec = bulk_slab("two_term_hg", bulk);
  std::get<TwoTermHg>(spec.bulk) = {g, -g, 0.5};
  const auto phase = [=](double angle) {
    return (oracles::henyey_greenstein(g)(angle) + oracles::henyey_greenstein(-g)(angle)) / 2;
  };
  return crossing(flux_of(make_scene(spec), paths).shares, bulk, phase,
                  static_cast<int>(6 / (1 - g)));
}

/// Checks a phase-function table that is 0 outside a cone around the forward direction.
Finding cone(double half, const Bulk& bulk, std::uint64_t paths) {
  const std::string path = std::filesystem::temp_directory_path() / "flatspeckle_cone.csv";
  std::ofstream(path) << std::setprecision(17) << "angle,value\n0,1\n"
                      << half << ",0\n"
                      << pi << ",0\n";
  SceneSpec spec = bulk_slab("phase_table", bulk);
  std::get<PhaseTable>(spec.bulk).phase_table = path;
  const Scene scene = make_scene(spec);
  std::filesystem::remove(path);
  const auto phase = [=](double angle) {
    return std::max(0.0, 1 - std::abs(std::remainder(angle, 2 * pi)) / half) / half;
  };
  return crossing(flux_of(scene, paths).shares, bulk, phase, 200);
}

/// Checks the absorptance of a weak absorber, 1 - albedo times the mean number of collisions.
Finding absorbed(double albedo) {
  const auto shares = flux({20, 0, albedo}, 8000).shares;
  const oracles::IsotropicSlab theory(k, mc_depth, 20 / mc_depth, albedo);
  return in_errors(shares.absorptance.value[0], shares.absorptance.error[0], theory.absorbed(0),
                   0.05, 1e-3);
}

void add_intensities(ExtremeRows& rows) {
  const std::string theory = "integral equation, in errors";
  constexpr auto yes = ReversedPaths::yes, no = ReversedPaths::no;
  using Angles = std::vector<double>;
  const auto add = [&](const char* name, auto... of) {
    const std::string_view slow[] = {"slab of OD 100",
                                     "slab of OD 5 of a thousand layers, with reversed paths"};
    rows.add_timed(std::ranges::count(slow, name) > 0, name, theory, isotropic_slab, of...);
  };
  add("slab of OD 1e-3, with reversed paths", Bulk{1e-3}, Angles{0, 0.8}, Angles{0.1, -1, pi, 2.2},
      yes, 8000, 1);
  add("slab of OD 100", Bulk{100}, Angles{0}, Angles{0.1, -1, 2.2}, no, 32000, 1);
  add("slab of OD 5 of a thousand layers, with reversed paths", Bulk{5}, Angles{0, 1.5},
      Angles{0.1, -1.5, 2.2}, yes, 160000, 1000);
  add("slab of OD 5, albedo 1 - 1e-9", Bulk{5, 0, 1 - 1e-9}, Angles{0}, Angles{0.1, pi}, no, 16000,
      1);
  add("slab of OD 1, light at 1.5, views at 1.54 and 1.61", Bulk{1}, Angles{1.5},
      Angles{0.1, 1.54, -1.54, 1.61, pi + 1.5}, no, 640000, 1);
  rows.add("slab, lights and views at exactly pi/2", "nothing is seen", along);
  rows.add("slab of albedo 0", "no covariance", black);
  for (const double g : {-0.999, 0.999})
    for (const double depth : {0.01, 2.0})
      rows.add("slab of OD " + short_number(depth) + ", g " + short_number(g),
               "scattered power, in errors", scattered_power, g, depth);
  rows.add("slab of OD 2.5, k L from 63 to 6e6", "the same intensities", wavelength);
  rows.add("slab of OD 5, k L 1e6, tilts q L to 2", theory, tilted_fields);
  rows.add("slab of OD 3, k L 1e6, tilt 0 of grazing light", "correlation 1, no error", untilted);
}

void add_flux(ExtremeRows& rows) {
  const std::string energy = "reflected + transmitted = scattered";
  rows.add("flux, OD 1e-12", energy, lossless_flux, Bulk{1e-12}, 4000);
  rows.add("flux, OD 100, g 0.999", energy, lossless_flux, Bulk{100, 0.999}, 1000);
  rows.add_slow("flux, OD 1e4", energy, lossless_flux, Bulk{1e4}, 400);
  const std::string ordinates = "discrete ordinates, in errors";
  rows.add("flux, OD 30, albedo 0.7: 1e-9 transmitted", ordinates, one_peak, Bulk{30, 0, 0.7},
           100000);
  rows.add("flux, OD 1e-3, g 0.5, albedo 0.7", ordinates, one_peak, Bulk{1e-3, 0.5, 0.7}, 50000);
  rows.add("flux, OD 5, peaks of g 0.95 forwards and backwards", ordinates, two_peaks, 0.95,
           Bulk{5}, 20000);
  rows.add("flux, OD 10, albedo 0.9, a table that is 0 beyond 1", ordinates, cone, 1,
           Bulk{10, 0, 0.9}, 40000);
  rows.add("flux, OD 20, albedo 1 - 1e-9: absorbed", "integral equation, in errors", absorbed,
           1 - 1e-9);
  rows.add("flux, OD 2, albedo 0: absorbed", "1 - exp(-2)", [] {
    const auto shares = flux({2, 0, 0}, 1000).shares;
    return Finding{std::abs(shares.absorptance.value[0] / -std::expm1(-2.0) - 1.0), 1e-12};
  });
  rows.add_slow("flux, OD 100, g 0.99: reflected", "800 ordinates a quadrant, in errors", [] {
    const auto shares = flux({100, 0.99}, 40000).shares;
    return in_errors(shares.reflectance.value[0], shares.reflectance.error[0], 0.31914, 0.01, 3e-5);
  });
}

}  // namespace

void mc_slab_extremes(ExtremeRows& rows) {
  add_intensities(rows);
  add_flux(rows);
}

}  // namespace flatspeckle::bench

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>

#include <boost/math/distributions/chi_squared.hpp>

#include "bench/oracles/quadrature.h"
#include "core/numbers/random.h"
#include "grin/media/scattering/phase_function.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/flux.h"
#include "tests/mc/flux_runs.h"

namespace flatspeckle::mc::test_flux {

namespace {

using oracles::henyey_greenstein;
using oracles::SlabTransport;
using tests::paths;
using tests::pi;

/// Returns the sum of reflectance, transmittance, side loss and absorptance, per light.
Estimate total(const tests::FluxRun& run) {
  return jackknife(run.sums, [&](double samples, std::span<const Complex> all) {
    std::vector<Complex> totals(run.job.lights);
    for (std::size_t light = 0; light < run.job.lights; ++light)
      for (std::size_t share = 0; share < 4; ++share)
        totals[light] += all[light * all.size() / run.job.lights + share] / samples;
    return totals;
  });
}

Scene lit_box(double width, double depth, const tests::HgBulk& bulk,
              const std::vector<double>& lights) {
  return tests::hg_box(width, depth, bulk, intensity_request(lights, tests::far_views({0})));
}

/// Counts photons where they leave a box, sharing only random numbers with the estimator. Returns
/// the shares reflected, transmitted, through the sides, absorbed; unscattered ones do not count.
std::vector<double> count_photons(const Scene& scene, double light, int photons) {
  RandomStream random(7, 80, 0);
  const Domain& box = scene.domain;
  const grin::HenyeyGreenstein<2> phase{scene.scatterer.g};
  const double face = box.width * std::cos(light), side = box.depth * std::sin(light);
  std::vector<double> ended(4);
  for (int i = 0; i < photons; ++i) {
    double angle = light;
    Vec x{(random.uniform() - 0.5) * box.width, 0};
    if (random.uniform() * (face + side) > face) x = {-box.width / 2, random.uniform() * box.depth};
    for (bool scattered = false;; scattered = true) {
      const Vec start = x, w = direction(angle);
      x = x - std::log(random.uniform()) / scene.medium.mu_t * w;
      if (!box.contains(x)) {
        const Vec end = start + box.distance_to_edge(start, w) * w;
        const bool sideways = std::abs(end.x) > box.width / 2 - 1e-9;
        if (scattered) ended[sideways ? 2 : w.z > 0 ? 1 : 0] += 1.0 / photons;
        break;
      }
      if (random.uniform() > scene.medium.albedo) {
        ended[3] += 1.0 / photons;
        break;
      }
      angle += phase.sample(random.uniform());
    }
  }
  return ended;
}

}  // namespace

TEST_CASE("flux of slabs agrees with discrete ordinates to 2 %") {
  std::uint64_t seed = 0;
  for (const double optical_depth : {0.1, 1.0, 10.0})
    for (const double g : {0.0, 0.5, 0.9, -0.5})
      for (const double albedo : {1.0, 0.99, 0.5})
        if (const auto i = seed++; tests::is_night || (i + i / 3 + i / 12) % 3 == 0)
          tests::check_slab(optical_depth, albedo, g, 0.02, seed);
}

TEST_CASE("flux of a slab of cylinders agrees with discrete ordinates") {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 200;
  spec.scatterer = "tm";
  spec.radius = 0.4;
  spec.index = "1.33+0.01i";
  spec.optical_depth = 2;
  const Scene scene = make_scene(spec);
  const auto flux = tests::run_flux(scene, paths(100000), 1).flux;
  const auto& medium = scene.medium;
  const auto phase = [&](double angle) {
    return std::norm(amplitude(medium.t_matrix, scene.k, angle)) / medium.cross_sections.scattering;
  };
  const SlabTransport theory({2, medium.albedo, phase}, {0}, 60);
  CHECK_WITHIN_4_SIGMA(flux.reflectance.value[0], flux.reflectance.error[0], theory.reflectance(0),
                       0);
  CHECK_WITHIN_4_SIGMA(flux.transmittance.value[0], flux.transmittance.error[0],
                       theory.transmittance(0), 0);
  CHECK(flux.reflectance.error[0] < 0.02 * flux.reflectance.value[0].real());
}

namespace {

SceneSpec bulk_slab(const std::string& phase) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 200;
  spec.scatterer = phase;
  spec.albedo = 0.95;
  spec.optical_depth = 2;
  return spec;
}

/// Compares flux and covariance of a slab with theory for the same phase function.
void check_bulk(const SceneSpec& spec, const std::function<double(double)>& phase) {
  const Scene scene = make_scene(spec);
  const auto flux = tests::run_flux(scene, paths(200000), 1).flux;
  const SlabTransport theory({2, 0.95, phase}, {0, 0.3, 2.5}, 60);
  CHECK_WITHIN_4_SIGMA(flux.reflectance.value[0], flux.reflectance.error[0], theory.reflectance(0),
                       0);
  CHECK_WITHIN_4_SIGMA(flux.transmittance.value[0], flux.transmittance.error[0],
                       theory.transmittance(0), 0);
  CHECK(flux.reflectance.error[0] < 0.01 * flux.reflectance.value[0].real());
  SceneSpec seen = spec;
  seen.view_angles = {0.3, 2.5};
  const Scene views = make_scene(seen);
  const auto job = covariance_job(views, make_plan(views, ReversedPaths::no), 2);
  RunState state;
  run_batches(job.batches, {paths(40000), 2, "", {}}, state);
  const Estimate found = field_moments(job, state.sums).covariance;
  for (std::size_t v = 0; v < 2; ++v)
    CHECK_WITHIN_4_SIGMA(found.value[v], found.error[v],
                         theory.covariance_without_reversed(0, seen.view_angles[v]), 0);
}

}  // namespace

TEST_CASE("two-term Henyey-Greenstein slabs agree with discrete ordinates") {
  SceneSpec spec = bulk_slab("two_term_hg");
  std::get<TwoTermHg>(spec.bulk) = {0.8, -0.3, 0.7};
  CHECK(make_scene(spec).medium.g == doctest::Approx(0.7 * 0.8 - 0.3 * 0.3));
  check_bulk(spec, [](double angle) {
    return 0.7 * henyey_greenstein(0.8)(angle) + 0.3 * henyey_greenstein(-0.3)(angle);
  });
}

TEST_CASE("slabs with a tabulated phase function agree with discrete ordinates") {
  const auto shape = [](double angle) {
    return 1 + std::cos(angle) / 2 + std::cos(angle) * std::cos(angle);
  };
  const std::string path = std::filesystem::temp_directory_path() / "flatspeckle_phase.csv";
  std::ofstream table(path);
  table << "angle,value\n" << std::setprecision(17);
  for (int i = 0; i <= 720; ++i) table << i * pi / 720 << ',' << 5 * shape(i * pi / 720) << '\n';
  table.close();
  SceneSpec spec = bulk_slab("phase_table");
  std::get<PhaseTable>(spec.bulk).phase_table = path;
  CHECK(make_scene(spec).medium.g == doctest::Approx(1.0 / 6).epsilon(1e-5));
  check_bulk(spec, [&](double angle) { return shape(angle) / (3 * pi); });
  std::filesystem::remove(path);
}

TEST_CASE("flux of a slab: exit angles follow the distribution of discrete ordinates") {
  const double light = pi / 3, optical_depth = 2, g = 0.5;
  constexpr std::size_t bins = 24;
  constexpr std::uint64_t photons = 400000;
  const Scene scene = tests::lit_slab(optical_depth, 1, g, {light});
  const auto flux = tests::run_flux(scene, paths(photons), 3, bins).flux;
  oracles::GaussPanels views;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double from = 2 * pi * static_cast<double>(bin) / bins - pi;
    views.add(from, from + 2 * pi / bins);
  }
  auto angles = views.node;
  angles.push_back(light);
  const SlabTransport theory({optical_depth, 1, henyey_greenstein(g)}, angles, 40);
  // Without absorption walks leave with their initial weight, so that bins are counts.
  const double scattered = 1 - theory.direct_transmittance(light);
  double chi_squared = 0, all = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    double expected = 0;
    for (std::size_t i = bin * views.node.size() / bins; i < (bin + 1) * views.node.size() / bins;
         ++i)
      expected += photons * views.weight[i] / scattered / std::cos(light) *
                  theory.covariance_without_reversed(light, views.node[i]);
    const double found =
        photons * flux.exit_radiance.value[bin].real() * (2 * pi / bins) / scattered;
    CHECK(expected > 5);
    chi_squared += (found - expected) * (found - expected) / expected;
    all += expected;
  }
  CHECK(all == doctest::Approx(photons).epsilon(1e-4));
  const boost::math::chi_squared distribution(bins - 1);
  CHECK(boost::math::cdf(boost::math::complement(distribution, chi_squared)) > 1e-3);
}

TEST_CASE("flux of a box agrees with counted photons") {
  constexpr int photons = 200000;
  const double light = 0.7;
  for (const tests::HgBulk& bulk : {tests::HgBulk{2, -0.4, 0.8}, tests::HgBulk{1, 0.8, 1}}) {
    const Scene scene = lit_box(10, 6, bulk, {light});
    const auto flux = tests::run_flux(scene, paths(photons), 4).flux;
    const auto counted = count_photons(scene, light, photons);
    const Estimate* shares[] = {&flux.reflectance, &flux.transmittance, &flux.side_loss,
                                &flux.absorptance};
    for (std::size_t share = 0; share < 4; ++share) {
      CAPTURE(share);
      const double error = std::sqrt(counted[share] * (1 - counted[share]) / photons);
      CHECK_WITHIN_4_SIGMA(shares[share]->value[0], std::hypot(error, shares[share]->error[0]),
                           counted[share], 1e-12);
    }
  }
}

TEST_CASE("flux of a box: shares add up to the extinction for light from every side") {
  const std::vector<double> lights = {0, 0.6, -pi / 2, 2.4, pi};
  for (const double albedo : {1.0, 0.9, 0.3}) {
    for (const double g : {0.0, 0.9}) {
      const Scene scene = lit_box(8, 30, {0.5, g, albedo}, lights);
      const auto run = tests::run_flux(scene, paths(tests::is_night ? 6000 : 2000), 5);
      const Estimate sum = total(run);
      for (std::size_t light = 0; light < lights.size(); ++light) {
        CAPTURE(albedo);
        CAPTURE(lights[light]);
        CHECK_WITHIN_4_SIGMA(sum.value[light], sum.error[light],
                             1 - direct_transmittance(scene, lights[light]), 1e-12);
        CHECK(sum.error[light] < 0.03 * tests::effort().errors);
      }
    }
  }
}

TEST_CASE("flux of a lossless slab: every walk conserves power") {
  for (const double optical_depth : {1e-3, 3.0, 100.0}) {
    const Scene scene = tests::lit_slab(optical_depth, 1, 0.5, {0, 1.0});
    const Estimate sum = total(tests::run_flux(scene, paths(4000), 6));
    for (std::size_t light = 0; light < 2; ++light) {
      const double scattered = 1 - direct_transmittance(scene, scene.request.lights[light].angle);
      CHECK(std::abs(sum.value[light] - scattered) < 1e-11 * scattered);
    }
  }
}

TEST_CASE("flux of a box: invariant under mirroring and quarter turns") {
  const tests::HgBulk bulk{1, 0.6, 0.95};
  const auto tall = tests::run_flux(lit_box(4, 9, bulk, {0.5, -0.5, pi - 0.5}), paths(40000), 8);
  const auto wide = tests::run_flux(lit_box(9, 4, bulk, {pi / 2 - 0.5}), paths(40000), 9);
  const auto same = [](const Estimate& a, std::size_t i, const Estimate& b, std::size_t j) {
    CHECK_WITHIN_4_SIGMA(a.value[i], std::hypot(a.error[i], b.error[j]), b.value[j], 0);
  };
  same(tall.flux.reflectance, 0, tall.flux.reflectance, 1);
  same(tall.flux.reflectance, 0, tall.flux.transmittance, 2);
  same(tall.flux.side_loss, 0, tall.flux.side_loss, 2);
  same(tall.flux.absorptance, 0, wide.flux.absorptance, 0);
  const auto faces = [](const FluxEstimates& flux) {
    return flux.reflectance.value[0] + flux.transmittance.value[0];
  };
  const double error = std::hypot(wide.flux.reflectance.error[0], wide.flux.transmittance.error[0],
                                  tall.flux.side_loss.error[0]);
  CHECK_WITHIN_4_SIGMA(faces(wide.flux), error, tall.flux.side_loss.value[0], 0);
}

TEST_CASE("direct transmittance of a box: equals the mean over its chords") {
  for (const double light : {0.0, 0.3, 1.2, -pi / 2, 2.0, pi}) {
    const Scene scene = lit_box(7, 3, {2}, {light});
    const Vec w = direction(light);
    const double face = 7 * std::abs(w.z), side = 3 * std::abs(w.x);
    constexpr int points = 20000;
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      const double t = (i + 0.5) / points;
      const Vec on_face{7 * (t - 0.5), w.z > 0 ? 0.0 : 3.0};
      const Vec on_side{std::copysign(3.5, -w.x), 3 * t};
      sum += face * std::exp(-0.5 * scene.domain.distance_to_edge(on_face, w)) / points;
      sum += side * std::exp(-0.5 * scene.domain.distance_to_edge(on_side, w)) / points;
    }
    CHECK(direct_transmittance(scene, light) == doctest::Approx(sum / (face + side)).epsilon(1e-6));
  }
}

TEST_CASE("flux: a share that no path has reached does not meet a target error") {
  const auto request = intensity_request({0}, tests::far_views({0}));
  StopRule stop;
  stop.target_error = 0.05;
  const auto dark = tests::run_flux(tests::layered({{10, 60, 0, 0.3}}, request), stop, 14);
  CHECK(dark.flux.transmittance.value[0] == 0.0);
  CHECK(dark.flux.reflectance.error[0] < 0.01 * dark.flux.reflectance.value[0].real());
  CHECK(std::isinf(dark.job.batches.relative_error(dark.sums)));
}

TEST_CASE("flux of extreme slabs: thin, without scattering, almost lossless") {
  const auto thin = tests::run_flux(tests::lit_slab(1e-3, 0.7, 0.5, {0.4}), paths(50000), 11).flux;
  const SlabTransport theory({1e-3, 0.7, henyey_greenstein(0.5)}, {0.4}, 30);
  tests::check_share(thin.reflectance, 0, theory.reflectance(0.4));
  tests::check_share(thin.transmittance, 0, theory.transmittance(0.4));
  CHECK(thin.reflectance.error[0] < 0.01 * theory.reflectance(0.4));

  const auto black = tests::run_flux(tests::lit_slab(2, 0, 0, {0}), paths(1000), 12);
  CHECK(black.flux.reflectance.value[0] == 0.0);
  CHECK(black.flux.absorptance.value[0].real() == doctest::Approx(1 - std::exp(-2.0)));
  CHECK(black.job.batches.relative_error(black.sums) < 1e-12);

  const auto lossless = tests::run_flux(tests::lit_slab(20, 1, 0, {0}), paths(4000), 13).flux;
  const auto nearly = tests::run_flux(tests::lit_slab(20, 1 - 1e-9, 0, {0}), paths(4000), 13).flux;
  CHECK(std::abs(nearly.transmittance.value[0] - lossless.transmittance.value[0]) < 1e-6);
  CHECK(nearly.absorptance.value[0].real() > 1e-9);
  CHECK(nearly.absorptance.value[0].real() < 1e-7);
}

TEST_CASE("flux: independent of the threads and of the unit of length") {
  const auto in_units = [](double unit, int threads) {
    const auto request = intensity_request({0.3}, tests::far_views({0}));
    const Scene scene = tests::hg_slab(10 * unit, {2 * unit, 0.5, 0.9}, request, unit);
    const FluxJob job = flux_job(scene, 4, 1);
    RunOptions options;
    options.stop.samples = 2000;
    options.threads = threads;
    RunState state;
    run_batches(job.batches, options, state);
    return flux_estimates(job, state.sums).reflectance.value[0];
  };
  CHECK(in_units(1, 1) == in_units(1, 3));
  CHECK(std::abs(in_units(1, 1) - in_units(1024, 1)) < 1e-12);
}

}  // namespace flatspeckle::mc::test_flux

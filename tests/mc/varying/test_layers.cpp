// Layers against adding and doubling of discrete ordinates, and equal ones against one slab.
#include <cmath>
#include <memory>

#include "flatland/media/layers.h"
#include "mc/paths/layers/layer_gradient.h"
#include "tests/mc/flux_runs.h"

namespace flatspeckle::mc::test_layers {

namespace {

using tests::Layer;
using tests::layered;
using tests::pi;

const std::vector<Layer> three = {{20, 2, 0.9, 0.99}, {30, 3, 0.7, 0.9}, {10, 1, 0, 1}};

oracles::SlabTransport theory_of(const std::vector<Layer>& layers,
                                 const std::vector<double>& angles) {
  std::vector<oracles::SlabTransport::Medium> media;
  for (const auto& [thickness, optical_depth, g, albedo] : layers)
    media.push_back({optical_depth, albedo, oracles::henyey_greenstein(g)});
  return {media, angles, tests::is_night ? 60 : 40};
}

}  // namespace

TEST_CASE("layers: optical depth along a ray and its inverse, the reach, agree") {
  const Scene scene = layered(three, intensity_request({0}, tests::far_views({0})));
  const MediumProfile& profile = *scene.profile;
  for (const Vec x : {Vec{0, 0}, {0, 19.999}, {3, 35}, {0, 60}})
    for (const double angle : {0.0, 0.7, pi / 2, 2.0, pi, 4.0}) {
      const Vec w = direction(angle);
      const double edge = std::min(100.0, scene.domain.distance_to_edge(x, w));
      for (const double share : {0.01, 0.4, 0.99}) {
        const double depth = profile.optical_depth(x, w, share * edge);
        CHECK(profile.reach(x, w, depth, edge) == doctest::Approx(share * edge).epsilon(1e-9));
      }
      CHECK(profile.reach(x, w, 1e3, edge) == edge);
    }
  CHECK(profile.optical_depth({0, 10}, {0, 1}, 45) == doctest::Approx(1 + 3 + 0.5));
}

TEST_CASE("adding and doubling: unequal parts of one medium give the whole") {
  const std::vector<double> angles = {0.3, 1.0};
  const auto whole = theory_of({{0, 5, 0.5, 0.95}}, angles),
             parts =
                 theory_of({{0, 2, 0.5, 0.95}, {0, 0.3, 0.5, 0.95}, {0, 2.7, 0.5, 0.95}}, angles);
  for (const double light : angles) {
    CHECK(parts.reflectance(light) == doctest::Approx(whole.reflectance(light)).epsilon(1e-11));
    CHECK(parts.transmittance(light) == doctest::Approx(whole.transmittance(light)).epsilon(1e-11));
    CHECK(parts.covariance_without_reversed(light, -0.3) ==
          doctest::Approx(whole.covariance_without_reversed(light, -0.3)).epsilon(1e-11));
  }
}

TEST_CASE("layers: flux of three layers agrees with adding and doubling") {
  const std::vector<double> lights = {0, 1.0};
  const Scene scene = layered(three, intensity_request(lights, tests::far_views({0})));
  const FluxEstimates flux =
      tests::run_flux(scene, tests::paths(tests::shortened(400'000)), 5).flux;
  const auto theory = theory_of(three, lights);
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const double back = theory.reflectance(lights[light]),
                 through = theory.transmittance(lights[light]),
                 direct = theory.direct_transmittance(lights[light]);
    tests::check_share(flux.reflectance, light, back);
    tests::check_share(flux.transmittance, light, through);
    tests::check_share(flux.absorptance, light, 1 - back - through - direct);
    CHECK(flux.transmittance.error[light] < 0.004 * tests::effort().errors * through);
    CHECK(direct_transmittance(scene, lights[light]) == doctest::Approx(direct).epsilon(1e-13));
  }
}

TEST_CASE("layers: intensities of three layers agree with adding and doubling") {
  // In transmission reversed paths change only the weights of paths.
  const std::vector<double> views = {0.1, -0.8, 1.2};
  for (const auto reversed : {ReversedPaths::no, ReversedPaths::yes}) {
    auto layers = three;
    if (reversed == ReversedPaths::yes) std::swap(layers.front(), layers.back());
    const auto theory = theory_of(layers, {0.3, 0.1, -0.8, 1.2});
    const Scene scene = layered(layers, intensity_request({0.3}, tests::far_views(views)));
    const auto found = tests::run(scene, reversed, 300'000, 11).entries();
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Complex expected = theory.covariance_without_reversed(0.3, views[v]);
      CHECK_WITHIN_4_SIGMA(found.value[v], found.error[v], expected, 0);
      CHECK(found.error[v] < (tests::is_night ? 0.01 : 0.025) * std::abs(expected));
    }
  }
}

TEST_CASE("layers: equal layers give the covariance of the undivided slab") {
  const auto request = memory_effect_request(2 * pi, 0.2, {0.1, pi - 0.3}, {0, 0.01, 0.05});
  const Scene parts =
                  layered({{2, 1, 0.5, 0.95}, {1, 0.5, 0.5, 0.95}, {7, 3.5, 0.5, 0.95}}, request),
              whole = tests::hg_slab(10, {2, 0.5, 0.95}, request);
  const auto a = tests::run(parts, ReversedPaths::yes, 200'000, 1).entries(),
             b = tests::run(whole, ReversedPaths::yes, 200'000, 2).entries();
  for (std::size_t e = 0; e < a.value.size(); ++e)
    CHECK_WITHIN_4_SIGMA(a.value[e], std::hypot(a.error[e], b.error[e]), b.value[e], 0);
}

TEST_CASE("layers: derivatives by each layer agree with adding and doubling") {
  const double light = 0.3;
  const std::vector<double> views = {0.1, -0.8};
  const Scene scene = layered(three, intensity_request({light}, tests::far_views(views)));
  const Plan plan = gradient_plan(scene, ReversedPaths::no);
  const GradientJob job = layer_gradient_job(scene, plan, 7);
  const auto found =
      jackknife(tests::summed(job.field.batches, tests::shortened(200'000)), job.gradient);
  const std::vector<double Layer::*> members = {&Layer::optical_depth, &Layer::g, &Layer::albedo};
  REQUIRE(job.parameters.size() == 9);
  CHECK(job.parameters[3] == "mu_t of layer 2");
  for (std::size_t p = 0; p < 9; ++p) {
    const auto moved = [&](double by) {
      auto layers = three;
      layers[p / 3].*members[p % 3] += by;
      return theory_of(layers, {light, 0.1, -0.8});
    };
    constexpr double step = 1e-4;
    const auto more = moved(step), less = moved(-step);
    for (std::size_t v = 0; v < views.size(); ++v) {
      double expected = (more.covariance_without_reversed(light, views[v]) -
                         less.covariance_without_reversed(light, views[v])) /
                        (2 * step);
      if (p % 3 == 0) expected *= three[p / 3].thickness;  // by mu_t
      const std::size_t e = p * views.size() + v;
      CAPTURE(job.parameters[p]);
      CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], Complex(expected), 1e-4);
    }
  }
}

}  // namespace flatspeckle::mc::test_layers

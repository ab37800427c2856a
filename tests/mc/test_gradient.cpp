#include <cmath>
#include <functional>

#include <doctest/doctest.h>

#include "bench/oracles/quadrature.h"
#include "bench/oracles/slab_theory.h"
#include "core/error.h"
#include "mc/paths/endpoint_factors/endpoint_factors.h"
#include "mc/paths/estimators/gradient.h"
#include "mc/slab/slab_covariance.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_gradient {

namespace {

using tests::HgBulk;
using tests::pi;
using Channel = oracles::IsotropicSlab::Channel;

constexpr double k = 2 * pi;

Channel angles(const Scene& scene, std::uint32_t channel) {
  const auto [i, v] = scene.request.channels[channel];
  return {angle_of(-light_endpoints(scene)[i].towards), angle_of(view_endpoints(scene)[v].towards)};
}

struct GradientRun {
  GradientJob job;
  GroupedSums sums;
  std::size_t entries;

  Estimate covariance() const { return jackknife(sums, job.field.covariance); }
  /// Returns the derivatives of all entries by one parameter.
  Estimate gradient(const std::string& parameter) const {
    const std::size_t p = static_cast<std::size_t>(
        std::find(job.parameters.begin(), job.parameters.end(), parameter) -
        job.parameters.begin());
    REQUIRE(p < job.parameters.size());
    return jackknife(sums, [&](double samples, std::span<const Complex> total) {
      const auto all = job.gradient(samples, total);
      const auto first = all.begin() + static_cast<std::ptrdiff_t>(p * entries);
      return std::vector<Complex>(first, first + static_cast<std::ptrdiff_t>(entries));
    });
  }
};

GradientRun differentiate(const Scene& scene, const Plan& plan, std::uint64_t paths,
                          std::uint64_t seed) {
  GradientRun result{gradient_job(scene, plan, seed), {}, scene.request.entries.size()};
  result.sums = tests::summed(result.job.field.batches, tests::shortened(paths));
  return result;
}

GradientRun differentiate(const Scene& scene, ReversedPaths reversed, std::uint64_t paths,
                          std::uint64_t seed) {
  return differentiate(scene, gradient_plan(scene, reversed), paths, seed);
}

/// Returns the central difference of fourth order.
template <typename F>
auto derivative(const F& f, double at, double step) -> decltype(f(at)) {
  return (8.0 * (f(at + step) - f(at - step)) - (f(at + 2 * step) - f(at - 2 * step))) /
         (12 * step);
}

void check_entries(const Estimate& found, const std::function<Complex(std::size_t)>& expected,
                   double bias = 0) {
  for (std::size_t e = 0; e < found.value.size(); ++e) {
    CAPTURE(e);
    const Complex value = expected(e);
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], value, bias * std::abs(value));
    CHECK(found.error[e] < 0.2 * std::abs(value));  // so that the check is significant
  }
}

/// Compares derivatives with finite differences of the integral equation, g = 0.
void check_against_slab_theory(const HgBulk& bulk, double depth, const CovarianceRequest& request,
                               ReversedPaths reversed, std::uint64_t paths, std::uint64_t seed) {
  const Scene scene = tests::hg_slab(depth, bulk, request);
  const auto theory = [&](std::size_t e, double mu_t, double albedo) {
    const oracles::IsotropicSlab slab(k, depth, mu_t, albedo, 200);
    const Channel a = angles(scene, request.entries[e].a), b = angles(scene, request.entries[e].b);
    return reversed == ReversedPaths::yes ? slab.with_reversed(a, b) : slab.without_reversed(a, b);
  };
  const auto run = differentiate(scene, reversed, paths, seed);
  const double mu_t = 1 / bulk.mean_free_path;
  const auto by_mu_t = [&](std::size_t e) {
    return derivative([&](double m) { return theory(e, m, bulk.albedo); }, mu_t, 0.02 * mu_t);
  };
  const auto by_albedo = [&](std::size_t e) {
    return derivative([&](double a) { return theory(e, mu_t, a); }, bulk.albedo, 0.003);
  };
  constexpr double discretization = 1e-3;
  check_entries(run.gradient("mu_t"), by_mu_t, discretization);
  check_entries(run.gradient("albedo"), by_albedo, discretization);
  check_entries(
      run.gradient("optical_depth"), [&](std::size_t e) { return by_mu_t(e) / depth; },
      discretization);
}

}  // namespace

TEST_CASE("gradients: their covariance equals that of the same paths without derivatives") {
  const auto request = memory_effect_request(k, 0.2, {0.1, 0.5}, {0.01, -0.05});
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    const Scene scene = tests::hg_box(20, 10, {4, 0.5, 0.9}, request);
    const auto with = differentiate(scene, reversed, 4000, 1).covariance();
    const auto without = tests::run(scene, reversed, 4000, 1).entries();
    for (std::size_t e = 0; e < without.value.size(); ++e)
      CHECK(std::abs(with.value[e] - without.value[e]) < 1e-12 * std::abs(without.value[e]));
  }
}

TEST_CASE("isotropic slab: derivatives by mu_t and albedo agree with the integral equation") {
  const auto views = intensity_request({0.3}, tests::far_views({0.1, 1.2, pi - 0.9, -2.0}));
  check_against_slab_theory({5, 0, 0.9}, 20, views, ReversedPaths::no, 200000, 11);
  check_against_slab_theory({40, 0, 0.5}, 20, views, ReversedPaths::no, 100000, 12);
  const auto tilts = memory_effect_request(k, 0.3, {0.5}, {0.01, -0.03});
  check_against_slab_theory({5, 0, 0.95}, 20, tilts, ReversedPaths::no, 200000, 13);
}

TEST_CASE(
    "isotropic slab: derivatives of the backscattering cone agree with the integral equation") {
  const double back = 0.2 + pi;
  const auto cone = intensity_request({0.2}, tests::far_views({back, back + 0.01, back - 0.06}));
  check_against_slab_theory({5, 0, 0.9}, 20, cone, ReversedPaths::yes, 200000, 14);
}

TEST_CASE("lossless slab: derivatives of scattered power by mu_t and g equal those of extinction") {
  oracles::GaussPanels views;
  for (const double start : {-pi, -pi / 2, 0.0, pi / 2}) views.add(start, start + pi / 2, 2);
  const auto request = intensity_request({0.6}, tests::far_views(views.node));
  for (const double g : {0.0, 0.7}) {
    CAPTURE(g);
    const double depth = 10, mu_t = 0.2, cosine = std::cos(0.6);
    const auto run =
        differentiate(tests::hg_slab(depth, {1 / mu_t, g}, request), ReversedPaths::no, 60000, 21);
    const auto of_all_views = [&](std::size_t p) {
      return jackknife(run.sums, [&](double samples, std::span<const Complex> total) {
        const auto all = run.job.gradient(samples, total);
        double sum = 0;
        for (std::size_t v = 0; v < views.node.size(); ++v)
          sum += views.weight[v] * all[p * views.node.size() + v].real();
        return std::vector<Complex>{sum};
      });
    };
    const auto by_mu_t = of_all_views(0), by_g = of_all_views(1);
    REQUIRE(run.job.parameters[1] == "g");
    CHECK_WITHIN_4_SIGMA(by_mu_t.value[0], by_mu_t.error[0],
                         depth * std::exp(-mu_t * depth / cosine), 1e-4);
    CHECK(by_mu_t.error[0] < 0.05 * tests::effort().errors);
    CHECK_WITHIN_4_SIGMA(by_g.value[0], by_g.error[0], 0.0, 1e-4);
    CHECK(by_g.error[0] < 0.02 * tests::effort().errors);
  }
}

TEST_CASE("single scattering: derivatives agree with the closed form") {
  const double depth = 10, light = 0.3, albedo = 1e-7;
  const std::vector<double> views = {0.1, 1.0, -2.5};
  for (const double g : {0.0, 0.6, -0.3}) {
    const auto closed_form = [&](double view, double mu_t, double its_albedo, double its_g) {
      const oracles::IsotropicSlab slab(k, depth, mu_t, its_albedo, 2);
      const double shape =
          (1 - its_g * its_g) / (1 + its_g * its_g - 2 * its_g * std::cos(view - light));  // C22
      return shape * slab.single({light, view}, {light, view});
    };
    const Scene scene =
        tests::hg_slab(depth, {5, g, albedo}, intensity_request({light}, tests::far_views(views)));
    const auto run = differentiate(scene, ReversedPaths::no, 1000, 31);
    const auto by_mu_t = run.gradient("mu_t"), by_g = run.gradient("g"),
               by_albedo = run.gradient("albedo");
    for (std::size_t v = 0; v < views.size(); ++v) {
      const auto check = [&](const Estimate& found, Complex expected) {
        CHECK(std::abs(found.value[v] - expected) < 1e-5 * std::abs(expected));
      };
      check(by_mu_t,
            derivative([&](double m) { return closed_form(views[v], m, albedo, g); }, 0.2, 1e-4));
      check(by_g,
            derivative([&](double a) { return closed_form(views[v], 0.2, albedo, a); }, g, 1e-4));
      check(by_albedo, closed_form(views[v], 0.2, 1, g));
    }
  }
}

TEST_CASE("single scattering by paths: derivatives agree with the closed form") {
  const auto request = pairs_request({{0.3, 0.1, 0.3, 0.1}, {0.3, 0.1, 0.33, 0.12}});
  const Scene scene = tests::hg_box(20, 10, {5, 0.4, 0.05}, request);
  Plan plan = gradient_plan(scene, ReversedPaths::no);
  REQUIRE_FALSE(plan.sampled_single);
  const auto exact = differentiate(scene, plan, 20000, 32);
  plan.sampled_single = true;
  const auto sampled = differentiate(scene, plan, 200000, 33);
  for (const char* parameter : {"mu_t", "g", "albedo"}) {
    CAPTURE(parameter);
    const auto found = sampled.gradient(parameter), expected = exact.gradient(parameter);
    for (std::size_t e = 0; e < found.value.size(); ++e)
      CHECK_WITHIN_4_SIGMA(found.value[e], std::hypot(found.error[e], expected.error[e]),
                           expected.value[e], 0);
  }
}

TEST_CASE("derivatives: a swapped pair of different channels gives the conjugate") {
  const auto request = pairs_request({{0.3, 0.1, -0.6, 1.4}, {0, 2.9, 0.5, -1.9}});
  auto swapped = request;
  for (auto& entry : swapped.entries) std::swap(entry.a, entry.b);
  const auto of = [](const CovarianceRequest& pairs) {
    return differentiate(tests::hg_box(2, 1, {0.5, 0.5, 0.9}, pairs), ReversedPaths::yes, 4000, 35);
  };
  const auto one = of(request), other = of(swapped);
  for (const char* parameter : {"mu_t", "g", "albedo"}) {
    const auto a = one.gradient(parameter), b = other.gradient(parameter);
    for (std::size_t e = 0; e < a.value.size(); ++e)
      CHECK(std::abs(a.value[e] - std::conj(b.value[e])) < 1e-9 * std::abs(a.value[e]));
  }
}

TEST_CASE("derivatives by g: agree with transport") {
  const auto request = pairs_request(
      {{0, 0.1, 0, 0.1}, {0, 1, 0, 1}, {0, 0.1, 0.02, 0.12}, {0, pi - 0.5, 0, pi - 0.5}});
  for (const bool reversed : {true, false}) {
    const Scene scene = tests::hg_slab(10, {3, reversed ? 0.5 : 0, 0.97}, request);
    const auto exact = slab_derivatives(scene, reversed, {1e-4}, BulkParameter::g).value;
    const auto paths = reversed ? ReversedPaths::yes : ReversedPaths::no;
    check_entries(differentiate(scene, paths, 200000, 41).gradient("g"),
                  [&](std::size_t e) { return exact[request.entries.size() + e]; });
  }
}

TEST_CASE("nightly: derivatives by g: agree with finite differences of long runs") {
  const auto request = pairs_request(
      {{0, 0.1, 0, 0.1}, {0, 1, 0, 1}, {0, 0.1, 0.02, 0.12}, {0, pi - 0.5, 0, pi - 0.5}});
  struct Case {
    double g, step;
    ReversedPaths reversed;
  };
  for (const Case& run : {Case{0.5, 0.06, ReversedPaths::yes}, Case{0, 0.1, ReversedPaths::no}}) {
    const double g = run.g, step = run.step;
    const auto reversed = run.reversed;
    CAPTURE(g);
    const auto found =
        differentiate(tests::hg_box(20, 10, {3, g, 0.97}, request), reversed, 200000, 41)
            .gradient("g");
    const auto at = [&](double its_g, std::uint64_t seed) {
      return tests::run(tests::hg_box(20, 10, {3, its_g, 0.97}, request), reversed, 400000, seed)
          .entries();
    };
    const auto up = at(g + step, 42), down = at(g - step, 43), up2 = at(g + 2 * step, 44),
               down2 = at(g - 2 * step, 45);
    for (std::size_t e = 0; e < found.value.size(); ++e) {
      CAPTURE(e);
      const Complex expected =
          (8.0 * (up.value[e] - down.value[e]) - (up2.value[e] - down2.value[e])) / (12 * step);
      const double error = std::hypot(8 * std::hypot(up.error[e], down.error[e]),
                                      std::hypot(up2.error[e], down2.error[e])) /
                           (12 * step);
      CHECK_WITHIN_4_SIGMA(found.value[e], std::hypot(found.error[e], error), expected, 0);
    }
  }
}

TEST_CASE("derivatives: satisfy reciprocity") {
  const auto gradient = [](double light, double view, std::uint64_t seed) {
    const Scene scene =
        tests::hg_box(20, 10, {4, 0.6, 0.95}, pairs_request({{light, view, light, view}}));
    return differentiate(scene, ReversedPaths::yes, 150000, seed);
  };
  const auto one = gradient(0.3, 2.9, 51), other = gradient(2.9 + pi, 0.3 + pi, 52);
  for (const char* parameter : {"mu_t", "g", "albedo"}) {
    CAPTURE(parameter);
    const auto a = one.gradient(parameter), b = other.gradient(parameter);
    CHECK_WITHIN_4_SIGMA(a.value[0], std::hypot(a.error[0], b.error[0]), b.value[0], 0);
  }
}

TEST_CASE("derivatives at a distant near sensor: agree with those of the far field") {
  const double r = 1e7;
  const std::vector<double> angles = {0.1, -2.8};
  std::vector<View> near;
  for (const double angle : angles) near.push_back(near_sensor(r * direction(angle)));
  const HgBulk bulk{4, 0.5, 1};
  const Scene far_scene =
      tests::hg_box(20, 10, bulk, intensity_request({0}, tests::far_views(angles)));
  const Scene near_scene = tests::hg_box(20, 10, bulk, intensity_request({0}, near));
  Plan plan = gradient_plan(near_scene, ReversedPaths::yes);
  REQUIRE(plan.sampled_single);
  plan.score_level = 0;  // no roulette, which ignores near sensors: the same paths
  const auto near_run = differentiate(near_scene, plan, 4000, 61);
  const auto far_run = differentiate(far_scene, plan, 4000, 61);
  for (const char* parameter : {"mu_t", "g", "albedo"}) {
    const auto a = near_run.gradient(parameter), b = far_run.gradient(parameter);
    for (std::size_t e = 0; e < angles.size(); ++e)
      CHECK(std::abs(r * a.value[e] - b.value[e]) < 1e-3 * std::abs(b.value[e]));
  }
}

TEST_CASE("derivatives of the memory effect: agree with the integral equation") {
  const double depth = 20, mu_t = 0.1, albedo = 0.9;
  std::vector<double> tilts;
  for (int t = 0; t < 9; ++t) tilts.push_back(0.006 * t);
  const auto request = memory_effect_request(k, 0.1, {0.1}, tilts);
  const Scene scene = tests::hg_slab(depth, {1 / mu_t, 0, albedo}, request);
  const auto curve = [&](double its_mu_t, double its_albedo) {
    const oracles::IsotropicSlab slab(k, depth, its_mu_t, its_albedo, 200);
    std::vector<Complex> entries;
    for (const Entry entry : request.entries)
      entries.push_back(slab.without_reversed(angles(scene, entry.a), angles(scene, entry.b)));
    auto values = field_correlation(request, entries);
    values.emplace_back(depth * memory_effect_range(request.tilt_q, values).value);
    return Eigen::ArrayXcd(Eigen::ArrayXcd::Map(values.data(), std::ssize(values)));
  };
  REQUIRE(curve(mu_t, albedo).tail(1)[0].real() < depth * request.tilt_q.back());
  const auto run = differentiate(scene, ReversedPaths::no, 200000, 71);
  const CorrelationGradient found = gradient_estimates(scene, run.sums, run.job).effect;
  const std::size_t n = tilts.size(), g = 1, by_albedo = 2;
  REQUIRE(run.job.parameters[g] == "g");
  const auto of_mu_t = derivative([&](double m) { return curve(m, albedo); }, mu_t, 0.002),
             of_albedo = derivative([&](double a) { return curve(mu_t, a); }, albedo, 0.003);
  for (std::size_t t = 0; t <= n; ++t) {
    CAPTURE(t);
    const auto check = [&](std::size_t p, Complex expected) {
      const Estimate& part = t < n ? found.correlation : found.range;
      const std::size_t i = t < n ? p * n + t : p;
      CHECK_WITHIN_4_SIGMA(part.value[i], part.error[i], expected,
                           2e-3 * std::abs(expected) + 1e-9);
      if (t > 2)
        CHECK(part.error[i] <
              (p == by_albedo ? 0.05 : 0.3) * tests::effort().errors * std::abs(expected));
    };
    check(0, of_mu_t[t]);
    check(by_albedo, of_albedo[t]);
  }
}

TEST_CASE("derivatives of points: equal those of isotropic bulk, without g") {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.albedo = 0.8;
  spec.count = 60;
  spec.view_angles = {0.4, 2.0};
  const Scene points = make_scene(spec);
  const auto found = differentiate(points, ReversedPaths::yes, 100000, 81);
  CHECK(found.job.parameters == std::vector<std::string>{"mu_t", "albedo", "optical_depth"});
  const auto bulk =
      differentiate(tests::hg_box(20, 10, {1 / points.medium.mu_t, 0, 0.8}, points.request),
                    ReversedPaths::yes, 100000, 82);
  for (const auto& parameter : found.job.parameters) {
    const auto a = found.gradient(parameter), b = bulk.gradient(parameter);
    for (std::size_t e = 0; e < a.value.size(); ++e)
      CHECK_WITHIN_4_SIGMA(a.value[e], std::hypot(a.error[e], b.error[e]), b.value[e], 0);
  }
}

TEST_CASE("derivatives of cylinders: by mu_t, radius, index and optical depth") {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 10;
  spec.scatterer = "tm";
  spec.radius = 0.2;
  spec.optical_depth = 1;
  const Scene scene = make_scene(spec);
  CHECK(gradient_job(scene, gradient_plan(scene, ReversedPaths::no), 1).parameters ==
        std::vector<std::string>{"mu_t", "radius", "index", "optical_depth"});
}

TEST_CASE("derivatives: media without scattering and too many entries are rejected") {
  const auto request = intensity_request({0}, {far_view(0.1)});
  CHECK_THROWS_AS(gradient_plan(tests::hg_slab(10, {4, 0, 0}, request), ReversedPaths::automatic),
                  InputError);
  const std::vector<double> many(210, 0.1);
  const auto full = full_request({0}, tests::far_views(many));
  CHECK_THROWS_AS(gradient_plan(tests::hg_box(20, 10, {4}, full), ReversedPaths::automatic),
                  InputError);
}

}  // namespace flatspeckle::mc::test_gradient

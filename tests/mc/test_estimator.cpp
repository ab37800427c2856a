#include <cmath>
#include <complex>

#include <doctest/doctest.h>
#define lapack_complex_double std::complex<double>
#define lapack_complex_float std::complex<float>
#include <lapacke.h>

#include "core/error.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_estimator {

namespace {

using tests::HgBulk;
using tests::pi;
using Kind = CovarianceRequest::Kind;

const std::vector<double> lights = {0, 0.2, -0.7};
const std::vector<double> views = {0.1, 1.5, pi, pi - 0.2};

Scene points_in_box(const CovarianceRequest& request) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = 60;
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

/// Checks each entry, with a tolerance relative to the largest.
void check_same(const std::vector<Complex>& found, const std::vector<Complex>& expected,
                double tolerance) {
  REQUIRE(found.size() == expected.size());
  double largest = 0;
  for (const Complex value : expected) largest = std::max(largest, std::abs(value));
  REQUIRE(largest > 0);
  for (std::size_t e = 0; e < found.size(); ++e) {
    CAPTURE(e);
    CHECK(std::abs(found[e] - expected[e]) < tolerance * largest);
  }
}

void check_4_sigma(const Estimate& found, const Estimate& expected, double bias = 0) {
  REQUIRE(found.value.size() == expected.value.size());
  for (std::size_t e = 0; e < found.value.size(); ++e) {
    CAPTURE(e);
    CHECK_WITHIN_4_SIGMA(found.value[e], std::hypot(found.error[e], expected.error[e]),
                         expected.value[e], bias * std::abs(expected.value[e]));
  }
}

std::vector<double> eigenvalues(const std::vector<Complex>& lower_rows, int n) {
  std::vector<Complex> matrix(n * n);
  std::size_t entry = 0;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b <= a; ++b) matrix[a + b * n] = lower_rows[entry++];
  std::vector<double> values(n);
  LAPACKE_zheev(LAPACK_COL_MAJOR, 'N', 'L', n, matrix.data(), n, values.data());
  return values;
}

/// Samples and scores every path, so that scenes that differ only in lights, views or entries use
/// the same paths.
Estimate estimate(const Scene& scene, ReversedPaths reversed, std::uint64_t paths,
                  std::uint64_t seed) {
  Plan plan = make_plan(scene, reversed);
  plan.sampled_single = true;
  plan.score_level = 0;
  return tests::run(scene, plan, paths, seed).entries();
}

}  // namespace

TEST_CASE("full covariance: equals listed entries and is positive semidefinite") {
  const auto full = full_request(lights, tests::far_views(views));
  auto listed = full;  // the same entries by the other accumulator, on the same paths
  listed.kind = Kind::pairs;
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    const auto matrix = estimate(points_in_box(full), reversed, 20000, 1);
    check_same(matrix.value, estimate(points_in_box(listed), reversed, 20000, 1).value, 1e-12);
    const int n = static_cast<int>(full.channels.size());
    const auto spectrum = eigenvalues(matrix.value, n);
    CHECK(spectrum.front() > -1e-12 * spectrum.back());
    std::size_t entry = 0;
    for (int a = 0; a < n; ++a) {
      entry += a;
      CHECK(std::abs(matrix.value[entry].imag()) < 1e-12 * spectrum.back());  // the diagonal
      ++entry;
    }
  }
}

TEST_CASE(
    "full covariance of many channels: agrees with listed entries on the same small batches") {
  std::vector<double> many;
  for (int v = 0; v < 70; ++v) many.push_back(-pi + 0.09 * v);
  const auto full = full_request(lights, tests::far_views(many));
  REQUIRE(full.channels.size() > 200);
  auto listed = full;
  listed.kind = Kind::pairs;
  const std::uint64_t per_batch = make_plan(points_in_box(full), ReversedPaths::no).paths_per_batch;
  const auto found = tests::run(points_in_box(full), ReversedPaths::no, 200, 2);
  const auto expected = tests::run(points_in_box(listed), ReversedPaths::no, 200, 2, per_batch);
  CHECK(found.sums.total_samples() == expected.sums.total_samples());
  check_same(found.entries().value, expected.entries().value, 1e-12);
}

TEST_CASE("intensities: equal the diagonal of the full covariance") {
  const auto far = tests::far_views(views);
  const auto full =
      estimate(points_in_box(full_request(lights, far)), ReversedPaths::yes, 10000, 3);
  const auto diagonal =
      estimate(points_in_box(intensity_request(lights, far)), ReversedPaths::yes, 10000, 3);
  std::vector<Complex> expected;
  for (std::size_t a = 0; a < diagonal.value.size(); ++a)
    expected.push_back(full.value[a * (a + 1) / 2 + a]);
  check_same(diagonal.value, expected, 1e-12);
}

TEST_CASE("covariance: a swapped pair gives the conjugate") {
  auto pairs = full_request(lights, tests::far_views(views));
  pairs.kind = Kind::pairs;
  auto swapped = pairs;
  for (auto& entry : swapped.entries) std::swap(entry.a, entry.b);
  const auto one = estimate(points_in_box(pairs), ReversedPaths::yes, 5000, 4);
  auto other = estimate(points_in_box(swapped), ReversedPaths::yes, 5000, 4);
  for (Complex& value : other.value) value = std::conj(value);
  check_same(other.value, one.value, 1e-12);
}

TEST_CASE("covariance of a box: scales linearly with the unit of length") {
  const double unit = 7.3;
  auto request = full_request(lights, tests::far_views(views));
  request.views.push_back(near_sensor({1, 12}));
  for (std::uint32_t light = 0; light < lights.size(); ++light)
    request.channels.push_back({light, static_cast<std::uint32_t>(views.size())});
  request.entries.push_back({12, 12});  // near: |u|^2 falls off as length / r: does not scale
  request.entries.push_back({14, 13});
  auto scaled = request;
  scaled.views.back() = near_sensor({unit, 12 * unit});
  request.kind = scaled.kind = Kind::pairs;
  for (const double albedo : {1.0, 0.7}) {
    const auto base =
        estimate(tests::hg_box(20, 10, {4, 0.5, albedo}, request), ReversedPaths::yes, 5000, 5);
    auto found =
        estimate(tests::hg_box(20 * unit, 10 * unit, {4 * unit, 0.5, albedo}, scaled, unit),
                 ReversedPaths::yes, 5000, 5);
    const std::size_t far_entries = found.value.size() - 2;
    for (std::size_t e = 0; e < far_entries; ++e) {
      found.value[e] /= unit;
      found.error[e] /= unit;
    }
    check_same(found.value, base.value, 1e-9);
    for (std::size_t e = 0; e < found.error.size(); ++e)
      CHECK(found.error[e] == doctest::Approx(base.error[e]).epsilon(1e-6));
  }
}

TEST_CASE("covariance per unit length of a slab: independent of the unit of length") {
  const double unit = 7.3;
  const auto request = memory_effect_request(2 * pi, 0.2, {0.3, pi - 0.2}, {0.01});
  const auto scaled = memory_effect_request(2 * pi / unit, 0.2, {0.3, pi - 0.2}, {0.01});
  const auto base = estimate(tests::hg_slab(10, {4, 0.5}, request), ReversedPaths::yes, 5000, 6);
  const auto found = estimate(tests::hg_slab(10 * unit, {4 * unit, 0.5}, scaled, unit),
                              ReversedPaths::yes, 5000, 6);
  check_same(found.value, base.value, 1e-9);
}

TEST_CASE("covariance: invariant under mirroring left to right") {
  const std::vector<AnglePair> pairs = {
      {0.3, 0.1, 0.32, 0.12}, {0.3, 2.9, 0.33, 2.87}, {0.7, -1, 0.7, -1}};
  std::vector<AnglePair> mirrored;
  for (const auto& p : pairs) mirrored.push_back({-p.light1, -p.view1, -p.light2, -p.view2});
  const HgBulk bulk{4, 0.6};
  check_4_sigma(
      estimate(tests::hg_box(20, 10, bulk, pairs_request(mirrored)), ReversedPaths::yes, 100000, 7),
      estimate(tests::hg_box(20, 10, bulk, pairs_request(pairs)), ReversedPaths::yes, 100000, 8));
}

TEST_CASE("covariance of a box: mirroring front to back adds the phase of the shifted origin") {
  const double depth = 10, k = 2 * pi;
  const std::vector<AnglePair> pairs = {
      {0.3, 0.1, 0.32, 0.12}, {0.3, 2.9, 0.33, 2.87}, {0.7, -1, 0.7, -1}};
  std::vector<AnglePair> mirrored;
  for (const auto& p : pairs)
    mirrored.push_back({pi - p.light1, pi - p.view1, pi - p.light2, pi - p.view2});
  const HgBulk bulk{4, 0.6, 0.9};
  auto found = estimate(tests::hg_box(20, depth, bulk, pairs_request(mirrored)), ReversedPaths::yes,
                        100000, 9);
  for (std::size_t e = 0; e < pairs.size(); ++e) {
    const auto& p = pairs[e];
    const double shift =
        std::cos(p.light1) - std::cos(p.view1) - std::cos(p.light2) + std::cos(p.view2);
    found.value[e] *= std::polar(1.0, k * depth * shift);
  }
  check_4_sigma(found, estimate(tests::hg_box(20, depth, bulk, pairs_request(pairs)),
                                ReversedPaths::yes, 100000, 10));
}

TEST_CASE("reciprocity of a box: exchanged light and view give the same covariance") {
  const std::vector<AnglePair> pairs = {{0.3, 0.1, 0.3, 0.1},
                                        {0.3, 0.1, 0.34, 0.13},
                                        {0.2, 3.3, 0.2, 3.3},
                                        {0.2, pi + 0.2, 0.23, pi + 0.18},
                                        {0, 1.8, 0, 1.8}};
  std::vector<AnglePair> swapped;
  for (const auto& p : pairs)
    swapped.push_back({p.view1 + pi, p.light1 + pi, p.view2 + pi, p.light2 + pi});
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    const HgBulk bulk{4, 0.7, 0.95};
    check_4_sigma(
        estimate(tests::hg_box(20, 10, bulk, pairs_request(swapped)), reversed, 150000, 11),
        estimate(tests::hg_box(20, 10, bulk, pairs_request(pairs)), reversed, 150000, 12));
  }
}

TEST_CASE(
    "reciprocity of a slab: C(i, v) = C(v, i) in transmission, (v + pi, i + pi) in reflection") {
  const HgBulk bulk{3, 0.6};
  const auto one = estimate(
      tests::hg_slab(10, bulk, intensity_request({0.3}, tests::far_views({1.0, pi + 1.0}))),
      ReversedPaths::yes, 100000, 13);
  const auto other = estimate(
      tests::hg_slab(10, bulk, intensity_request({1.0}, tests::far_views({0.3, pi + 0.3}))),
      ReversedPaths::yes, 100000, 14);
  check_4_sigma(other, one);
}

TEST_CASE("reversed paths: leave transmission unchanged (unbiased weights)") {
  // short wavelength: the contribution of reversed paths averages to 0
  const auto request = full_request({0, 0.01}, tests::far_views({0.3, 0.31, -0.9}));
  for (const double g : {0.0, 0.8}) {
    const Scene scene = tests::hg_box(20, 10, {10.0 / 3, g}, request, 0.01);
    check_4_sigma(estimate(scene, ReversedPaths::yes, 150000, 15),
                  estimate(scene, ReversedPaths::no, 150000, 16), 2e-3);
  }
}

TEST_CASE("Henyey-Greenstein with g = 0: equals a box of points") {
  const auto request = full_request(lights, tests::far_views(views));
  const Scene points = points_in_box(request);
  const Scene isotropic = tests::hg_box(20, 10, {1 / points.medium.mu_t, 0, 1}, request);
  check_same(estimate(isotropic, ReversedPaths::yes, 5000, 17).value,
             estimate(points, ReversedPaths::yes, 5000, 17).value, 1e-9);
  // g -> 0 is continuous, though it uses the other kernel
  const Scene almost = tests::hg_box(20, 10, {1 / points.medium.mu_t, 1e-12, 1}, request);
  check_same(estimate(almost, ReversedPaths::yes, 5000, 17).value,
             estimate(points, ReversedPaths::yes, 5000, 17).value, 1e-8);
}

TEST_CASE("thin TM cylinders: equal isotropic scatterers of their cross-section") {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.scatterer = "tm";
  spec.radius = 0.05 / (2 * pi);
  spec.optical_depth = 0.01;
  const auto request = full_request({0, 0.1}, tests::far_views({0.1, 1.0, pi}));
  Scene cylinders = make_scene(spec);
  cylinders.request = request;
  // more of them than would fit: Monte Carlo uses only the density
  const double more = 200;
  cylinders.medium.density *= more;
  cylinders.medium.mu_s *= more;
  cylinders.medium.mu_t *= more;
  const Scene isotropic = tests::hg_box(20, 10, {1 / cylinders.medium.mu_t}, request);
  check_4_sigma(estimate(cylinders, ReversedPaths::yes, 50000, 18),
                estimate(isotropic, ReversedPaths::yes, 50000, 19), 2e-3);
}

TEST_CASE("distant near sensor: agrees with the far field over sqrt(r)") {
  const double r = 1e7;
  const std::vector<double> angles = {0.1, 1.4, -2.8, pi - 0.2};
  std::vector<View> near;
  for (double angle : angles) near.push_back(near_sensor(r * direction(angle)));
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    const auto far_field =
        estimate(tests::hg_box(20, 10, {4, 0.5}, full_request({0, 0.2}, tests::far_views(angles))),
                 reversed, 5000, 20);
    auto near_field =
        estimate(tests::hg_box(20, 10, {4, 0.5}, full_request({0, 0.2}, near)), reversed, 5000, 20);
    for (Complex& value : near_field.value) value *= r;  // all sensors on one circle
    check_same(near_field.value, far_field.value, 1e-3);
  }
}

TEST_CASE("plan: reversed paths and weights only for scenes that need them") {
  const auto plan_of = [](double light, double view, double albedo) {
    return make_plan(
        tests::hg_box(20, 10, {4, 0.5, albedo}, intensity_request({light}, {far_view(view)})),
        ReversedPaths::automatic);
  };
  CHECK_FALSE(plan_of(0, 0.3, 1).reversed);
  CHECK(plan_of(0, 3, 1).reversed);
  CHECK(plan_of(3, 0.2, 1).reversed);
  CHECK_FALSE(plan_of(3, 2.9, 1).reversed);
  // illumination and view from the side of a box: exact backscattering, and within the cone
  CHECK(plan_of(pi / 2, -pi / 2, 1).reversed);
  CHECK(plan_of(1.55, -1.565, 1).reversed);
  CHECK_FALSE(plan_of(0, 0.3, 1).weighted);
  CHECK(plan_of(0, 0.3, 1 - 1e-9).weighted);
}

}  // namespace flatspeckle::mc::test_estimator

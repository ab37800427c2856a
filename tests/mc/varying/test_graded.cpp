#include <algorithm>
#include <cmath>
#include <fstream>

#include <doctest/doctest.h>

#include "core/error.h"
#include "mc/paths/bent/graded_endpoints.h"
#include "mc/paths/bent/linear_medium.h"
#include "mc/paths/walk/first_scatterer.h"
#include "mc/paths/walk/scene_scattering.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_graded {

namespace {

using tests::pi;
using Kind = IndexField::Kind;

IndexField linear(Vec slope) {
  IndexField field;
  field.kind = Kind::linear;
  field.gradient = slope;
  return field;
}

IndexField parabolic(double alpha) {
  IndexField field;
  field.kind = Kind::parabolic;
  field.alpha = alpha;
  return field;
}

IndexField blobs(double height) {
  IndexField field;
  field.kind = Kind::blobs;
  field.blobs = {{{1, 2}, height, 2.5}, {{-2, 4}, -height / 2, 2}};
  return field;
}

CovarianceRequest near_request() {
  return full_request({point_source({0, -2}), point_source({0.4, -2})},
                      {near_sensor({0.5, 7}), near_sensor({0, -2.5})});
}

Scene graded(const IndexField& field, const CovarianceRequest& request,
             const tests::HgBulk& bulk = {4}) {
  Scene scene = tests::hg_box(8, 5, bulk, request);
  scene.index = field;
  return scene;
}

Scene graded(const IndexField& field) {
  return graded(field, near_request());
}

/// Checks a wave at x by central differences: the eikonal's gradient is n w, and the amplitude
/// conserves the power of a tube of rays, div(amplitude^2 n w) = 0.
void check_eikonal(const GradedMedium& medium, const Wavefront& wave, Vec x, double tolerance) {
  const double h = 1e-3;
  const auto path = [&](Vec at) { return wave.at(at)->path; };
  const auto power = [&](Vec at) {
    const Arrival here = *wave.at(at);
    return here.amplitude * here.amplitude * std::sqrt(medium.square(at)) * here.w;
  };
  const Vec along{h, 0}, deep{0, h};
  const Arrival here = *wave.at(x);
  const Vec v = std::sqrt(medium.square(x)) * here.w;
  CAPTURE(x.x);
  CAPTURE(x.z);
  CHECK((path(x + along) - path(x - along)) / (2 * h) == doctest::Approx(v.x).epsilon(tolerance));
  CHECK((path(x + deep) - path(x - deep)) / (2 * h) == doctest::Approx(v.z).epsilon(tolerance));
  const double divergence = (power(x + along).x - power(x - along).x +  //
                             power(x + deep).z - power(x - deep).z) /
                            (2 * h);
  CHECK(std::abs(divergence) < 20 * tolerance * here.amplitude * here.amplitude);
}

}  // namespace

TEST_CASE("graded index: waves satisfy the eikonal equation and conserve power") {
  const std::vector<std::pair<IndexField, double>> fields = {{linear({0, 0.06}), 1e-6},
                                                             {linear({0.03, -0.05}), 1e-6},
                                                             {parabolic(0.06), 2e-3},
                                                             {blobs(0.06), 2e-3}};
  for (const auto& row : fields) {
    CAPTURE(row.first.describe());
    const auto& [field, tolerance] = row;
    const Scene scene = graded(field);
    const auto medium = graded_medium(scene);
    std::vector<std::shared_ptr<const Wavefront>> waves;
    waves.push_back(medium->from_point({0, -2}));
    waves.push_back(medium->from_point({0.5, 7}));
    if (field.gradient.x == 0) waves.push_back(medium->from_afar(0.3));
    if (field.gradient.x == 0) waves.push_back(medium->from_afar(pi - 0.2));
    for (const auto& wave : waves)
      for (const Vec x : {Vec{0.3, 0.4}, {-3.1, 2.2}, {2.7, 4.6}})
        check_eikonal(*medium, *wave, x, tolerance);
  }
}

TEST_CASE("graded index: a plane wave enters as in index 1, with its full power") {
  const Scene scene = graded(linear({0, 0.06}));
  const auto medium = graded_medium(scene);
  const auto wave = medium->from_afar(0.4);
  const Arrival here = *wave->at({1.7, 0});
  CHECK(here.path == doctest::Approx(1.7 * std::sin(0.4)));
  CHECK(here.amplitude == doctest::Approx(1));
  CHECK(here.w.x == doctest::Approx(std::sin(0.4)));
  CHECK(here.inside == 0);
  const Arrival deep = *wave->at({1.7, 5});
  CHECK(std::sqrt(1.3) * deep.w.x == doctest::Approx(std::sin(0.4)));
}

TEST_CASE("graded index: stepped rays and tables agree with closed forms") {
  const double alpha = 0.12;
  const Scene scene = graded(parabolic(alpha));
  const auto medium = graded_medium(scene);
  const auto after_flight = medium->after_flight({0.5, 0.2}, direction(0.3), 3);
  REQUIRE(after_flight);
  const double n = std::sqrt(1 - alpha * alpha * 0.25), vx = n * std::sin(0.3);
  CHECK(
      after_flight->x.x ==
      doctest::Approx(0.5 * std::cos(3 * alpha) + vx * std::sin(3 * alpha) / alpha).epsilon(1e-6));
  CHECK(after_flight->x.z == doctest::Approx(0.2 + 3 * n * std::cos(0.3)).epsilon(1e-6));
  CHECK_FALSE(medium->after_flight({0.5, 0.2}, direction(0.3), 20));
  CHECK(medium->inside({0, 1}, {0, 1}) == doctest::Approx(4).epsilon(1e-6));
}

TEST_CASE("graded index: a ray that leaves and returns counts only its length inside") {
  const LinearMedium medium({Domain::Kind::box, 30, 5}, linear({0, 0.2}));
  const double n = std::sqrt(1 + 0.2 * 0.05);
  const Vec w{std::sqrt(1 - 0.04), -0.2};
  const double inside = medium.inside({-14, 0.05}, w);
  // z = 0.05 - 0.2 n s + 0.05 s^2 is below 0 between its roots.
  const double square = std::sqrt(0.04 * n * n - 4 * 0.05 * 0.05), first = (0.2 * n - square) / 0.1,
               second = (0.2 * n + square) / 0.1,
               top = (0.2 * n + std::sqrt(0.04 * n * n + 0.2 * 4.95)) / 0.1;
  CHECK(inside == doctest::Approx(top - (second - first)));
  const auto place = medium.after_flight({-14, 0.05}, w, first + 0.5);
  REQUIRE(place);
  CHECK(place->x.x == doctest::Approx(-14 + w.x * n * (second + 0.5)));
}

TEST_CASE("graded index: first scatterers follow the stated density") {
  for (const IndexField& field : {linear({0.02, 0.06}), blobs(0.06)}) {
    const Scene scene =
        graded(field, intensity_request({point_source({1, -2})}, {near_sensor({0.5, 7})}), {1.5});
    const auto scattering = graded_scattering(scene);
    const GradedFirst first(scene, scattering);
    constexpr int columns = 8, rows = 5, fine = 40, samples = 20000;
    std::vector<double> counts(columns * rows), probabilities(columns * rows);
    const double dx = 8.0 / (columns * fine), dz = 5.0 / (rows * fine);
    for (int i = 0; i < columns * fine; ++i)
      for (int j = 0; j < rows * fine; ++j)
        probabilities[j / fine * columns + i / fine] +=
            dx * dz * first.density({-4 + (i + 0.5) * dx, (j + 0.5) * dz});
    RandomStream random(3, 79, 0);
    int missed = 0;
    for (int i = 0; i < samples; ++i) {
      const auto sample = first.sample(random);
      if (!sample.hit) {
        ++missed;
        continue;
      }
      REQUIRE(scene.domain.contains(sample.x));
      const int column = std::min(static_cast<int>((sample.x.x / 8 + 0.5) * columns), columns - 1),
                row = std::min(static_cast<int>(sample.x.z / 5 * rows), rows - 1);
      ++counts[row * columns + column];
    }
    CHECK(missed < samples / 20);
    counts.push_back(missed);
    double rest = 1;
    for (const double p : probabilities) rest -= p;
    probabilities.push_back(std::max(rest, 1e-4));
    flatspeckle::tests::check_chi_square(counts, probabilities);
  }
}

TEST_CASE("graded index: a negligible gradient gives the paths of a constant index") {
  for (const double g : {0.0, 0.6}) {
    Scene scene = graded(linear({0, 1e-9}), near_request(), {4, g});
    const auto bent = tests::run(scene, ReversedPaths::yes, 4000, 5).entries();
    scene.index.reset();
    const auto straight = tests::run(scene, ReversedPaths::yes, 4000, 5).entries();
    for (std::size_t e = 0; e < bent.value.size(); ++e)
      CHECK(std::abs(bent.value[e] - straight.value[e]) < 2e-6 * std::abs(straight.value[0]));
  }
}

TEST_CASE("graded index: exchanged source and sensor give the same intensity") {
  for (const IndexField& field : {linear({0, 0.1}), parabolic(0.1), blobs(0.08)}) {
    CAPTURE(field.describe());
    const Vec a{0, -2}, b{1, 7};
    const auto there =
        tests::run(graded(field, intensity_request({point_source(a)}, {near_sensor(b)})),
                   ReversedPaths::no, 50000, 5)
            .entries();
    const auto back =
        tests::run(graded(field, intensity_request({point_source(b)}, {near_sensor(a)})),
                   ReversedPaths::no, 50000, 6)
            .entries();
    CHECK_WITHIN_4_SIGMA(there.value[0], std::hypot(there.error[0], back.error[0]), back.value[0],
                         0);
    CHECK(there.error[0] < 0.03 * std::abs(there.value[0]));
  }
}

TEST_CASE("graded index: a slab transmits into matched views") {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 20;
  spec.scatterer = "hg";
  spec.optical_depth = 2;
  spec.index_field = "linear";
  spec.index_gradient = {0, 0.01};
  spec.covariance = "memory_effect";
  spec.tilts = {0, 0.01};
  spec.view_angles = {0.1, 3};
  const Scene scene = make_scene(spec);
  const auto bent = tests::run(scene, ReversedPaths::automatic, 20000, 5).entries();
  CHECK(std::abs(bent.value[0]) > 10 * bent.error[0]);
}

TEST_CASE("graded index: caustics and turning rays inside the medium are rejected") {
  // Parallel light is focused at z = pi / (2 alpha).
  const Scene scene = graded(parabolic(0.45), intensity_request({0.0}, {near_sensor({0, 8})}));
  CHECK_THROWS_AS(tests::run(scene, ReversedPaths::no, 400, 1), InputError);
  Scene turning = graded(linear({0, -0.15}), intensity_request({1.2}, {near_sensor({0, 8})}));
  CHECK_THROWS_AS(tests::run(turning, ReversedPaths::no, 400, 1), InputError);
}

}  // namespace flatspeckle::mc::test_graded

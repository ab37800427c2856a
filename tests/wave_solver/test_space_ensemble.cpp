// Ensembles of exact solutions in space against those of an independent program.

#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "core/error.h"
#include "tests/space_boxes.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::wave::test_space_ensemble {

namespace {

GroupedSums sums_of(const FieldJob& job, std::uint64_t placements) {
  GroupedSums sums(job.batches.size);
  for (std::uint64_t number = 0; number < placements; ++number) {
    std::vector<Complex> batch(job.batches.size);
    job.batches.run(number, batch);
    sums.add(job.batches.samples_per_batch, batch);
  }
  return sums;
}

void check_box(const std::string& name, std::uint64_t placements, double tolerance) {
  const auto expected = flatspeckle::tests::read_space_box(name);
  Scene scene = make_scene(flatspeckle::tests::space_box(name, name == "spheres_m2"));
  scene.request = expected.request;
  const FieldJob job = wave_job(scene, 3, tolerance);
  const Estimate found = field_moments(job, sums_of(job, placements)).covariance;
  double square = 0;
  for (std::size_t e = 0; e < expected.exact.size(); ++e) {
    CAPTURE(e);
    const double error = std::hypot(found.error[e], expected.exact_error[e]);
    const double off = std::abs(found.value[e] - expected.exact[e]);
    CHECK(off < 4 * error);
    CHECK(error < 0.2 * expected.mean_intensity);
    square += off * off / (error * error);
  }
  const double rms = std::sqrt(square / static_cast<double>(expected.exact.size()));
  MESSAGE(name, ": rms deviation ", rms, " errors");
  CHECK(rms < 1.5);
}

}  // namespace

TEST_CASE("ensemble in space: boxes of points agree with an independent ensemble") {
  check_box("points_resonant", 1500, 1e-6);
  check_box("points_offresonance", 1000, 1e-6);
}

TEST_CASE("ensemble in space: sources, beams and near sensors agree with an independent ensemble") {
  const Table table = read_csv(FLATSPECKLE_DATA "/reference/space/near_ends.csv");
  Scene scene = make_scene(flatspeckle::tests::space_box("points_resonant", false));
  const Lights lights{plane_wave(0.3), point_source({0.5, -1.5, -0.4}),
                      gaussian_beam(0.2, {0.3, 1, 0.2}, 1.5, 0.7)};
  const std::vector<View> views{far_view(0.7, 1), far_view(0.3 - std::numbers::pi),
                                near_sensor({0.4, 5, 0.3}), near_sensor({-1, 2, 0.5}),
                                near_sensor({0.5, 2.5, 3.6})};
  scene.request = intensity_request(lights, views);
  const FieldJob job = wave_job(scene, 5, 1e-6);
  const Estimate found = field_moments(job, sums_of(job, 250)).covariance;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    CAPTURE(row);
    const auto light = static_cast<std::size_t>(table.column("light")[row]),
               view = static_cast<std::size_t>(table.column("view")[row]), e = 5 * light + view;
    // The intensity inside the medium has an infinite variance, which errors underestimate.
    const double error = std::hypot(found.error[e], table.column("error")[row]),
                 allowed = view == 3 ? 0.3 * table.column("variance")[row] : 4 * error;
    CHECK(std::abs(found.value[e] - table.column("variance")[row]) < allowed);
    CHECK(error < 0.3 * table.column("variance")[row]);
  }
}

TEST_CASE("ensemble in space: a box of spheres agrees with an independent ensemble") {
  check_box("spheres_m2", 150, 1e-2);
}

TEST_CASE("nightly: ensemble in space: boxes agree with an independent ensemble") {
  check_box("points_resonant", 100000, 1e-6);
  check_box("points_offresonance", 100000, 1e-6);
  check_box("spheres_m2", 4000, 1e-2);
}

TEST_CASE("ensemble in space: scenes that cannot be solved are rejected") {
  const auto make = [](auto change) {
    SceneSpec spec = flatspeckle::tests::space_box("spheres_m2", true);
    change(spec);
    return wave_job(make_scene(spec), 1, 1e-3);
  };
  CHECK_NOTHROW(make([](SceneSpec&) {}));
  CHECK_THROWS_AS(make([](SceneSpec& spec) { spec.scatterer = "mie"; }), InputError);
  CHECK_THROWS_AS(make([](SceneSpec& spec) { spec.count = 2200; }), InputError);  // packing 0.37
  CHECK_THROWS_AS(make([](SceneSpec& spec) { spec.medium_index = 1.3; }), InputError);
}

}  // namespace flatspeckle::wave::test_space_ensemble

#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <doctest/doctest.h>

#include "grin/render/pictures/render_datasets.h"
#include "tests/grin/slab_renders.h"

// Reflectance and transmittance of a slab in one run, and media with two descriptions.

namespace flatspeckle::grin::tests::test_several_sensors {

namespace {

/// Returns a slab with detectors on both faces and of backward light by direction.
RenderScene both_faces(const ScatteringMedium& medium) {
  RenderScene scene = slab(medium, 2, 100, Face::reflected);
  scene.sensors.push_back(slab(medium, 2, 100, Face::transmitted).sensors[0]);
  scene.sensors.push_back(DirectionalDetector{{0, 0, -1}, {0, 1, 0}, std::numbers::pi / 2, {4, 3}});
  return scene;
}

ScatteringMedium medium_of(const SpacePhaseFunction& phase, double albedo) {
  ScatteringMedium medium = isotropic(albedo);
  medium.phase = phase;
  return medium;
}

void check_agree(double a, double error_a, double b, double error_b) {
  CAPTURE(a);
  CAPTURE(b);
  CHECK(std::abs(a - b) <= 4 * std::hypot(error_a, error_b));  // both may be dark
}

RenderResult result_of(const RenderScene& scene, RenderMethod method, double samples) {
  const RenderJob job = render_job(scene, {method}, 1);
  return render_result(scene, job, run_render(job, samples).sums);
}

/// Returns the reflectance and the transmittance of a slab.
std::pair<Estimate, Estimate> shares(const SpacePhaseFunction& phase, std::uint64_t seed) {
  const RenderScene scene = both_faces(medium_of(phase, 0.95));
  const RenderJob job = render_job(scene, {RenderMethod::light}, seed);
  const RenderResult result =
      render_result(scene, job, run_render(job, is_night ? 100000 : 40000).sums);
  return {*result[0].total, *result[1].total};
}

void check_same(const SpacePhaseFunction& a, const SpacePhaseFunction& b) {
  const auto [back_a, through_a] = shares(a, 1);
  const auto [back_b, through_b] = shares(b, 2);
  check_agree(back_a.value[0].real(), back_a.error[0], back_b.value[0].real(), back_b.error[0]);
  check_agree(through_a.value[0].real(), through_a.error[0], through_b.value[0].real(),
              through_b.error[0]);
  CHECK(back_a.error[0] < (is_night ? 2e-3 : 3e-3));
}

}  // namespace

TEST_CASE("several sensors of one run: agree with each sensor alone") {
  const RenderScene scene = both_faces(medium_of({HgPhase{0.5}}, 0.9));
  const double samples = is_night ? 50000 : 20000;
  for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
    const RenderResult all = result_of(scene, method, samples);
    REQUIRE(all.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      RenderScene alone = scene;
      alone.sensors = {scene.sensors[i]};
      const Estimate one = result_of(alone, method, samples)[0].picture.steady,
                     here = all[i].picture.steady;
      REQUIRE(here.value.size() == one.value.size());
      for (std::size_t pixel = 0; pixel < one.value.size(); ++pixel)
        check_agree(here.value[pixel].real(), here.error[pixel], one.value[pixel].real(),
                    one.error[pixel]);
    }
  }
}

TEST_CASE("lossless slab: reflectance and transmittance add up to 1") {
  for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
    const RenderScene scene = both_faces(medium_of({TwoTermPhase{{0.9}, {-0.3}, 0.8}}, 1));
    const RenderJob job = render_job(scene, {method}, 3);
    const RunState state = run_render(job, 50000);
    const double area = 4e4;
    const Estimate sum = jackknife(state.sums, [&](double samples, std::span<const Complex> sums) {
      return std::vector<Complex>{area * (sums[0] + sums[1]) / samples};
    });
    check_agree(sum.value[0].real(), sum.error[0], 1, 1e-3);
    CHECK(sum.error[0] < 5e-3);
  }
}

TEST_CASE("plan of several sensors: names all of them") {
  RenderScene scene = both_faces(isotropic(0.9));
  CHECK(render_job(scene, {}, 1).plan.find("; sensors 1 (area), 2 (area), 3 (directional)") !=
        std::string::npos);
  scene.sensor_names = {"back", "front", "far"};
  CHECK(render_job(scene, {}, 1).plan.find("front (area)") != std::string::npos);
}

TEST_CASE("slabs of two equal terms or of a table: agree with henyey_greenstein") {
  check_same({HgPhase{0.7}}, {TwoTermPhase{{0.7}, {0.7}, 0.4}});
  check_same({HgPhase{0.7}}, {TwoTermPhase{{0.7}, {-0.5}, 1}});
  const auto path = std::filesystem::temp_directory_path() /
                    ("flatspeckle-slab-" + std::to_string(::getpid()) + ".csv");
  std::ofstream file(path);
  file << "angle,value\n";
  for (int i = 0; i <= 400; ++i) {
    const double angle = std::numbers::pi * i / 400;
    file << angle << ',' << HenyeyGreenstein<3>{0.7}.density(angle) << '\n';
  }
  file.close();
  const TablePhase table(AngleTable("phase_table", path.string()));
  std::filesystem::remove(path);
  check_same({HgPhase{0.7}}, {table});
}

}  // namespace flatspeckle::grin::tests::test_several_sensors

#include <doctest/doctest.h>

#include "tests/grin/furnace.h"

namespace flatspeckle::grin::tests {

namespace {

const Light point = PointLight{Vec3(0.3, -0.2, 0.5)};
const Camera camera{Vec3(0, 0.2, -0.7), Vec3::UnitZ(), Vec3::UnitY(), 1.0, {2, 2}};
const AreaDetector detector{Vec3::UnitZ(), Vec3::UnitY(), 1, 1, {2, 1}, right_angle};

Stage ball_in_fog(const ScatteringMedium& around, const ScatteringMedium& inside) {
  Stage stage{unit_box(), around};
  stage.body = Body{Sphere{Vec3::Zero(), 0.7}, inside};
  return stage;
}

/// Scenes that no single one of the estimators finds easy.
std::vector<NamedScene> scenes() {
  const Stage foggy{unit_box(), fog(1.5, 0.1, 0.6)};
  const Stage luneburg = ball_in_fog(fog(0.3, 0, 0), fog(3, 0.05, 0.5));
  const Light beam = BeamLight{Vec3(0, 0, -0.99), Vec3::UnitZ(), 0.4};
  const Luneburg ball(LuneburgProfile{.radius = 0.7});
  return {
      {"point, camera, straight", scene_in(Homogeneous{0.2}, foggy, point, camera)},
      {"point, camera, fisheye",
       scene_in(Fisheye({.centre_excess = 0.7, .radius = 2}), foggy, point, camera)},
      {"point, camera, guide",
       scene_in(ParabolicGuide({.axis_excess = 0.5, .alpha = 0.6}), foggy, point, camera)},
      {"beam, detector, Luneburg ball", scene_in(ball, luneburg, beam, detector)},
      {"beam, directions, Luneburg ball",
       scene_in(ball, luneburg, beam,
                DirectionalDetector{Vec3::UnitZ(), Vec3::UnitY(), 0.7, {2, 1}})},
      {"point, detector, glass ball", scene_in(Homogeneous{0.5}, ball_in_fog(fog(1, 0, 0), {}),
                                               PointLight{Vec3(0.3, -0.2, -0.8)}, detector)},
      {"face, lens, glass ball",
       scene_in(Homogeneous{0.5}, ball_in_fog(fog(1, 0, 0), fog(0.5, 0.5, 0)),
                FaceLight{Vec3(0, 0, 1), 0.5, 1},
                Camera{-Vec3::UnitZ(), Vec3::UnitZ(), Vec3::UnitY(), 1.0, {1, 1}, 0.3, 1.0})},
      {"point, camera, grid", scene_in(Homogeneous{}, {unit_box(), grid_medium()}, point, camera)},
      {"point, detector, grid and fisheye", scene_in(Fisheye({.centre_excess = 0.7, .radius = 2}),
                                                     {unit_box(), grid_medium()}, point, detector)},
  };
}

bool is_beam(const Light& light) {
  return std::holds_alternative<BeamLight>(light);
}

struct Mean {
  double value, error;
};

Mean mean_of(const RenderScene& scene, RenderMethod method, double samples, std::uint64_t seed) {
  const RenderJob job = render_job(scene, {.method = method}, seed);
  const Estimate mean = pixel_mean(run_render(job, samples));
  return {mean.value[0].real(), mean.error[0]};
}

void check_agreement(const RenderScene& scene, double samples) {
  const Mean both = mean_of(scene, RenderMethod::bidirectional, samples, 11);
  for (const RenderMethod method : {RenderMethod::path, RenderMethod::light}) {
    // path tracing joins to where a beam scatters by 1/r^2 alone: rare paths carry much
    const bool rare = method == RenderMethod::path && is_beam(scene.lights.front());
    const double more = rare ? 20 : 2;
    // seeds differ: from the same paths they would agree too well
    const Mean one = mean_of(scene, method, more * samples, 12 + static_cast<int>(method));
    CAPTURE(name(method));
    CAPTURE(one.error / both.value);
    CAPTURE(both.error / both.value);
    CHECK(std::abs(one.value - both.value) < 4 * std::hypot(one.error, both.error));
  }
}

}  // namespace

TEST_CASE("path tracing, light tracing and bidirectional agree") {
  for (const NamedScene& named : scenes()) {
    CAPTURE(named.name);
    check_agreement(named.scene, 5e4);
  }
}

}  // namespace flatspeckle::grin::tests

#include <doctest/doctest.h>

#include "tests/grin/furnace_scenes.h"
#include "tests/grin/render_agreement.h"

namespace flatspeckle::grin::tests::test_render_agreement {

namespace {

const Light point = PointLight{Vec3(0.3, -0.2, 0.5)};
const Camera camera{Vec3(0, 0.2, -0.7), Vec3::UnitZ(), Vec3::UnitY(), 1.0, {2, 2}};

/// Returns scenes that are difficult for each of the estimators; by day those where few paths
/// suffice.
std::vector<NamedRender> scenes() {
  const Stage foggy{unit_box(), fog(1.5, 0.1, 0.6)};
  std::vector<NamedRender> all{
      {"face, lens, glass ball",
       scene_in(Homogeneous{0.5}, ball_in_fog(fog(1, 0, 0), fog(0.5, 0.5, 0)),
                FaceLight{Vec3(0, 0, 1), 0.5, 1},
                Camera{-Vec3::UnitZ(), Vec3::UnitZ(), Vec3::UnitY(), 1.0, {1, 1}, 0.3, 1.0})},
      {"fibre, detector, guide",
       scene_in(ParabolicGuide({.axis_excess = 0.5, .alpha = 0.6}), foggy,
                FibreLight{-Vec3::UnitZ(), Vec3::UnitZ(), 0.2, 0.4}, far_detector)},
      {"point, detector, grid and fisheye",
       scene_in(Fisheye({.centre_excess = 0.7, .radius = 2}), {unit_box(), grid_medium()}, point,
                far_detector)},
      {"point, camera, straight", scene_in(Homogeneous{0.2}, foggy, point, camera)},
      {"point, camera, fisheye",
       scene_in(Fisheye({.centre_excess = 0.7, .radius = 2}), foggy, point, camera)},
      {"point, camera, guide",
       scene_in(ParabolicGuide({.axis_excess = 0.5, .alpha = 0.6}), foggy, point, camera)},
      {"point, detector, glass ball", scene_in(Homogeneous{0.5}, ball_in_fog(fog(1, 0, 0), {}),
                                               PointLight{Vec3(0.3, -0.2, -0.8)}, far_detector)},
      {"Gaussian fibre, camera, glass ball",
       scene_in(Homogeneous{0.5}, ball_in_fog(fog(1, 0, 0), fog(0.5, 0.5, 0)),
                FibreLight{Vec3(0.4, 0.3, 0.8), -Vec3::UnitZ(), 0.05, 0.3, 1, Spread::gaussian},
                camera)},
      {"point, camera, grid", scene_in(Homogeneous{}, {unit_box(), grid_medium()}, point, camera)},
  };
  if (!is_night) all.resize(3);
  return all;
}

}  // namespace

TEST_CASE("path tracing, light tracing and bidirectional tracing agree") {
  for (const NamedRender& named : scenes()) {
    CAPTURE(named.name);
    const double samples = is_night && named.name.starts_with("face") ? 5e4 : agreement_samples;
    const Mean both = bidirectional_mean(named.scene, samples);
    for (const RenderMethod method : {RenderMethod::path, RenderMethod::light})
      check_agreement(named.scene, both, method, 2 * samples);
  }
}

TEST_CASE("light tracing and bidirectional tracing agree under a beam") {
  for (const NamedRender& named : beam_scenes()) {
    CAPTURE(named.name);
    check_agreement(named.scene, bidirectional_mean(named.scene), RenderMethod::light,
                    2 * agreement_samples);
  }
}

// Path tracing connects to the collisions of a beam by 1/r^2 alone: rare paths carry much of the
// light, so that it needs many paths.
TEST_CASE("nightly: path tracing and bidirectional tracing agree under a beam") {
  for (const NamedRender& named : beam_scenes()) {
    CAPTURE(named.name);
    check_agreement(named.scene, bidirectional_mean(named.scene), RenderMethod::path,
                    20 * agreement_samples);
  }
}

}  // namespace flatspeckle::grin::tests::test_render_agreement

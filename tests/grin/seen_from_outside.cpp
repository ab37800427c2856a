#include "tests/grin/seen_from_outside.h"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/grin/render_tests.h"

namespace flatspeckle::grin::tests {

using namespace oracles;

namespace {

const Camera small_lens{.x = {2, 0, 0},
                        .forward = {-1, 0, 0},
                        .up = {0, 1, 0},
                        .field_of_view = 1.2,
                        .pixels = {1, 1},
                        .lens_radius = 0.15,
                        .focus_distance = 2};
/// Returns the small lens with an aperture so wide that enough photons pass through it.
Camera wide_lens() {
  Camera lens = small_lens;
  lens.lens_radius = 0.4;
  return lens;
}

}  // namespace

TwoScenes body_from_outside(const AnyIndexField& field, const WalkScene& walk, const Light& light,
                            const PhotonSource& source, double power) {
  return {
      .scene = {.field = field,
                .step = 0.1,
                .max_length = 100,
                .stage = {.boundary = Box{{-2, -2, -2}, {2, 2, 2}},
                          .bodies = std::vector<Body>(1, {Sphere{}, {.mu_s = 0.5, .mu_a = 0.5}})},
                .lights = {light},
                .sensors = {wide_lens()}},
      .walk = walk,
      .source = source,
      .power = power,
      .sensor = lens_sensor(wide_lens())};
}

PhotonSource towards_ball() {
  return [all = point_source({0, 0, -1.5})](auto& random) {
    for (;;)
      if (const Photon one = all(random); one.direction.z() > 1 - 2 * share_towards_ball)
        return one;
  };
}

WalkScene ball_walk(double inside) {
  return {.boundary = {{-2, -2, -2}, {2, 2, 2}},
          .balls = {{Vec3::Zero(), 1, {.mu_s = 0.5, .mu_a = 0.5}, inside}}};
}

WalkScene luneburg_walk() {
  WalkScene walk = ball_walk(1);
  const auto n = [](const Vec3& x) { return std::sqrt(2 - x.squaredNorm()); };
  walk.curved = WalkIndex{n, [=](const Vec3& x) { return Vec3(-x / n(x)); }, 0.05};
  return walk;
}

void check_lens_and_pinhole(TwoScenes scenes, std::uint64_t photons, unsigned samples,
                            double precision) {
  const PhotonPicture picture = photon_picture(scenes, photons, 6);
  check_against(picture, scenes, {RenderMethod::bidirectional}, samples, precision);
  scenes.scene.sensors = {small_lens};
  const auto mean = [&](RenderMethod method) {
    const RenderJob job =
        render_job(scenes.scene, {.method = method}, flatspeckle::tests::fresh_seed(12));
    const Estimate found =
        pixel_mean(job, run_render(job, flatspeckle::tests::effort().samples * samples));
    return std::pair(found.value[0].real(), found.error[0]);
  };
  const auto by_lens = mean(RenderMethod::light);
  const double lens = by_lens.first, lens_error = by_lens.second;
  Camera pinhole = small_lens;
  pinhole.x[0] -= 1e-3;
  pinhole.lens_radius = 0;
  scenes.scene.sensors = {pinhole};
  for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
    const auto seen = mean(method);
    const double value = seen.first, error = seen.second;
    CAPTURE(value);
    CAPTURE(error);
    CAPTURE(lens);
    CAPTURE(lens_error);
    CHECK(std::abs(value - lens) < 4 * std::hypot(error, lens_error) + 0.005 * lens);
    CHECK(error < 1.5 * flatspeckle::tests::effort().errors * precision * lens);
  }
}

}  // namespace flatspeckle::grin::tests

#pragma once

#include <cmath>

#include <doctest/doctest.h>

#include "tests/grin/furnace.h"

namespace flatspeckle::grin::tests {

/// Number of path pairs for comparing bidirectional tracing with the other two methods.
inline const double agreement_samples = is_night ? 5e4 : 8e3;

inline const AreaDetector far_detector{Vec3::UnitZ(), Vec3::UnitY(), 1, 1, {2, 1}, right_angle};

inline Stage ball_in_fog(const ScatteringMedium& around, const ScatteringMedium& inside) {
  Stage stage{unit_box(), around};
  stage.bodies.push_back({Sphere{Vec3::Zero(), 0.7}, inside});
  return stage;
}

inline std::vector<NamedRender> beam_scenes() {
  const Stage luneburg = ball_in_fog(fog(0.3, 0, 0), fog(3, 0.05, 0.5));
  const Light beam = BeamLight{Vec3(0, 0, -0.99), Vec3::UnitZ(), 0.4};
  const Luneburg ball(LuneburgProfile{.radius = 0.7});
  return {{"beam, detector, Luneburg ball", scene_in(ball, luneburg, beam, far_detector)},
          {"beam, directions, Luneburg ball",
           scene_in(ball, luneburg, beam,
                    DirectionalDetector{Vec3::UnitZ(), Vec3::UnitY(), 0.7, {2, 1}})},
          {"Gaussian beam, detector, glass ball",
           scene_in(Homogeneous{0.5}, ball_in_fog(fog(1, 0, 0), fog(2, 0.1, 0)),
                    BeamLight{Vec3(0.2, 0, -0.99), Vec3::UnitZ(), 0.2, 1, Spread::gaussian},
                    far_detector)}};
}

struct Mean {
  double value, error;
};

inline Mean mean_of(const RenderScene& scene, RenderMethod method, double samples,
                    std::uint64_t seed) {
  const RenderJob job = render_job(scene, {.method = method}, flatspeckle::tests::fresh_seed(seed));
  const Estimate mean = pixel_mean(job, run_render(job, samples));
  const bool few =
      !mean.rare.empty() &&
      mean.rare[0] > 0;  // the error of an undersampled value is doubled, as in pictures
  return {mean.value[0].real(), (few ? 2 : 1) * mean.error[0]};
}

inline Mean bidirectional_mean(const RenderScene& scene, double samples = agreement_samples) {
  return mean_of(scene, RenderMethod::bidirectional, samples, 11);
}

inline void check_agreement(const RenderScene& scene, const Mean& both, RenderMethod method,
                            double samples) {
  // the seeds differ, because results from the same paths would agree too well
  const Mean one = mean_of(scene, method, samples, 12 + static_cast<int>(method));
  CAPTURE(name(method));
  CAPTURE(one.error / both.value);
  CAPTURE(both.error / both.value);
  CHECK(std::abs(one.value - both.value) < 4 * std::hypot(one.error, both.error));
}

}  // namespace flatspeckle::grin::tests

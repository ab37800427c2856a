// Fields of a realization after changes: delays and shifts of the frequency.

#include <algorithm>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/dynamics/frequency_shifts.h"
#include "mc/paths/speckle/camera_resolution.h"
#include "mc/paths/speckle/speckle_field.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_field_changes {

namespace {

Scene box(int dimension, const CovarianceRequest& request) {
  SceneSpec spec;
  spec.dimension = dimension;
  spec.width = 20;
  if (dimension == 3) spec.height = 20;
  spec.depth = 8;
  spec.scatterer = "hg";
  spec.g = 0.5;
  spec.optical_depth = 2;
  Scene scene = make_scene(spec);
  if (dimension == 3) scene = mc::in_space(scene, spec);
  scene.request = request;
  return scene;
}

/// Checks that the mean of u(0) conj(u(t)) over drawn fields is the covariance of a job, for each
/// change t and view. The first change must be none.
void check_covariances(Scene scene, const PathJob& job, const FieldChanges& changes,
                       ReversedPaths reversed) {
  constexpr std::uint64_t fields = 1500, paths = 20;
  const Estimate expected = jackknife(tests::summed(job.field.batches, 40000), job.all);
  scene.request = field_request(scene.request.lights, scene.request.views);
  const std::size_t views = scene.request.views.size();
  const auto draw = fields_by_paths(scene, make_plan(scene, reversed), 7, paths, changes);
  std::vector<Complex> field(changes.count() * views), sum(field.size());
  std::vector<double> intensity(field.size()), squares(field.size());
  for (std::uint64_t n = 0; n < fields; ++n) {
    draw(n, field, intensity);
    for (std::size_t i = 0; i < field.size(); ++i) {
      const Complex product = field[i % views] * std::conj(field[i]);
      sum[i] += product;
      squares[i] += std::norm(product);
    }
  }
  for (std::size_t i = 0; i < field.size(); ++i) {
    CAPTURE(i);
    const Complex mean = sum[i] / double(fields);
    const double error = std::hypot(std::sqrt(squares[i]) / double(fields), expected.error[i]);
    CHECK_WITHIN_4_SIGMA(mean, error, expected.value[i], 0);
    CHECK(error < 0.1 * std::abs(expected.value[i % views]));
  }
}

}  // namespace

TEST_CASE("field changes: covariances of drawn fields after delays agree with the covariance") {
  const std::vector<double> later{0.1, 0.4}, delays{0, 0.1, 0.4};
  const Motion flow{.diffusion = 0.5, .velocity = {0.2, 0.1}, .shear = 0.03};
  for (const int dimension : {2, 3})
    for (const Motion& motion : {Motion{}, flow}) {
      CAPTURE(dimension);
      const Scene scene = box(dimension, intensity_request({0.2}, far_views({0.4, 3.0})));
      const Plan plan = make_plan(scene, ReversedPaths::yes);
      check_covariances(scene, delay_job(scene, plan, later, 3, motion), {delays, motion},
                        ReversedPaths::yes);
    }
}

TEST_CASE("field changes: covariances of drawn fields at two frequencies agree") {
  const std::vector<double> shifts{0.003, 0.01};
  for (const int dimension : {2, 3}) {
    CAPTURE(dimension);
    const Scene scene = box(dimension, intensity_request({0.0}, far_views({0, tests::pi})));
    const Plan plan = frequency_plan(scene, ReversedPaths::yes);
    FieldChanges changes;
    changes.shifts = {0, 0.003, 0.01};
    check_covariances(scene, frequency_job(scene, plan, shifts, 3), changes, ReversedPaths::yes);
  }
}

TEST_CASE("field changes: fields on a camera agree with direct sums over its pixels") {
  const FarCamera camera{{0, 1, 0}, 0.2, 8};
  CovarianceRequest request = field_request({0.1}, camera.views());
  request.camera = camera;
  const Scene scene = box(3, request);
  const Plan plan = make_plan(scene, ReversedPaths::yes);
  const std::size_t views = camera.pixels * camera.pixels;
  FieldChanges moving{.delays = {0.5, 0}, .motion = {.velocity = {3, 1}, .shear = 0.5}}, shifted;
  shifted.shifts = {0.02, -0.01};
  for (const FieldChanges& changes : {moving, shifted}) {
    const auto resolution = camera_resolution(scene, plan, 1, 1e-4, changes.largest_moves(scene));
    std::vector<Complex> fast(2 * views), direct(2 * views);
    std::vector<double> intensity(2 * views), mean(2 * views);
    fields_on_camera(scene, plan, 5, 100, resolution, changes)(0, fast, intensity);
    fields_by_paths(scene, plan, 5, 100, changes)(0, direct, mean);
    double off = 0, all = 0;
    for (std::size_t i = 0; i < fast.size(); ++i) {
      off += std::norm(fast[i] - direct[i]);
      all += std::norm(direct[i]);
    }
    CHECK(std::sqrt(off / all) < 3e-4);
  }
}

}  // namespace flatspeckle::mc::test_field_changes

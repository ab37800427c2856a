#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "mc/paths/speckle/field_plan.h"
#include "mc/paths/speckle/lens_image.h"
#include "mc/slab/adding/space.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_lens_image {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

/// Image of a point scatterer at x with the far field exp(-i k v.x).
std::vector<Complex> image_of_point(Vec x, const FarCamera& lens, const LensPlane& plane) {
  const Domain box{Domain::Kind::box, 20, 20, 20};
  const FarCamera pupil = pupil_of(lens, plane, box, 1);
  std::vector<Complex> far, image(plane.pixels * plane.pixels);
  for (const View& view : pupil.views())
    far.push_back(std::polar(1.0, -k * dot(view.direction(), x)));
  LensImage(pupil, plane, k).form(far, image);
  return image;
}

}  // namespace

TEST_CASE("lens image: a point in focus has the Airy pattern of the pupil at its place") {
  constexpr double aperture = 0.1;
  const FarCamera lens{{0, 1, 0}, aperture, 0};
  const LensPlane plane{12, 20, 41};
  const Vec x{2, 12, -3};
  const auto image = image_of_point(x, lens, plane);
  const double peak = k * aperture * aperture / 2;
  for (std::size_t row = 0; row < plane.pixels; ++row)
    for (std::size_t column = 0; column < plane.pixels; ++column) {
      const double r = k * aperture *
                       std::hypot(plane.coordinate(column) - x.x, plane.coordinate(row) - x.y),
                   airy = r < 1e-9 ? 1 : 2 * ::j1(r) / r;
      // The weight 1 / v_z of directions differs from 1 by up to 0.5 %
      CHECK(std::abs(image[row * plane.pixels + column] - Complex(0, peak * airy)) < 0.01 * peak);
    }
}

TEST_CASE("lens image: on the axis of a point, out of focus, agrees with the closed form") {
  constexpr double aperture = 0.3, least_z = 0.9539392014169457;  // sqrt(1 - aperture^2)
  for (const double side : {1.0, -1.0}) {
    const FarCamera lens{{0, side, 0}, aperture, 0};
    for (const double focus : {-4.0, 3.0, 30.0}) {
      CAPTURE(focus);
      const Vec x{0, 5, 0};
      const Complex found = image_of_point(x, lens, {focus, 10, 1}).front();
      const double a = k * side * (focus - x.z);
      const Complex expected = k * (std::polar(1.0, a) - std::polar(1.0, a * least_z)) / a;
      CHECK(std::abs(found - expected) < 2e-3 * k * (1 - least_z));
    }
  }
}

TEST_CASE("lens image: excess kurtosis of images of few paths agrees with the survey") {
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = spec.height = 10;
  spec.depth = 5;
  spec.scatterer = "hg";
  spec.optical_depth = 1;
  Scene scene = mc::in_space(make_scene(spec), spec);
  const LensPlane plane{5, 6, 8};
  const FarCamera pupil = pupil_of({{0, 1, 0}, 0.2, 0}, plane, scene.domain, 1);
  scene.request = field_request({0.0}, pupil.views());
  scene.request.camera = pupil;
  const Plan plan = make_plan(scene, ReversedPaths::no);
  const PathSurvey survey =
      read_survey(tests::summed(survey_job(scene, plan, 1, plane), image_survey_paths));
  constexpr std::uint64_t images = 500, paths = 20;
  constexpr std::size_t pixels = 64;
  const auto draw = images_of(fields_by_paths(scene, plan, 1, paths),
                              LensImage(pupil, plane, scene.k), 1, scene.request.views.size());
  std::vector<Complex> image(pixels);
  std::vector<double> intensity(pixels), mean(pixels), square(pixels);
  for (std::uint64_t n = 0; n < images; ++n) {
    draw(n, image, intensity);
    for (std::size_t i = 0; i < pixels; ++i) {
      mean[i] += intensity[i] / images;
      square[i] += intensity[i] * intensity[i] / images;
    }
  }
  double found = 0, expected = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    found += (square[i] / (mean[i] * mean[i]) - 2) / pixels;
    expected += survey.excess[i] / double(paths) / pixels;
    CHECK(mean[i] > 0.5 * survey.intensity[i]);
    CHECK(mean[i] < 2 * survey.intensity[i]);
  }
  CHECK(found == doctest::Approx(expected).epsilon(0.2));
}

}  // namespace flatspeckle::mc::test_lens_image

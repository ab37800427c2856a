#include "tests/grin/photon_comparison.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "tests/grin/render_tests.h"

namespace flatspeckle::grin::tests {

namespace {

/// Returns the pixel at u (to the right) and v (up), nullopt beyond the half sides.
std::optional<int> pixel_of(const PixelGrid& grid, double u, double v, double half_u,
                            double half_v) {
  const double column = std::floor((u + half_u) / (2 * half_u) * grid.columns);
  const double row = std::floor((half_v - v) / (2 * half_v) * grid.rows);
  if (column < 0 || column >= grid.columns || row < 0 || row >= grid.rows) return {};
  return static_cast<int>(row) * grid.columns + static_cast<int>(column);
}

Vec3 upright(const Vec3& up, const Vec3& forward) {
  return (up - up.dot(forward) * forward).normalized();
}

double total_of(const std::vector<double>& values) {
  double sum = 0;
  for (double value : values) sum += value;
  return sum;
}

struct Compared {
  double a, a_error, b, b_error;
  bool agree() const { return std::abs(a - b) <= 4 * std::hypot(a_error, b_error); }
};

void check_all(const std::vector<Complex>& value, const std::vector<double>& error,
               const std::vector<double>& expected, const std::vector<double>& expected_error) {
  REQUIRE(value.size() == expected.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    // bins with hardly any detected light have no meaningful errors
    if (expected[i] < 5 * expected_error[i] || value[i].real() < 5 * error[i]) continue;
    const Compared c{value[i].real(), error[i], expected[i], expected_error[i]};
    CAPTURE(i);
    CAPTURE(c.a);
    CAPTURE(c.a_error);
    CAPTURE(c.b);
    CAPTURE(c.b_error);
    CHECK(c.agree());
  }
}

}  // namespace

PhotonSensor area_sensor(const AreaDetector& detector, const Vec3& outward, double sphere_radius) {
  const Vec3 v = upright(detector.up, outward), u = outward.cross(v);
  const double pixel_area =
      detector.width * detector.height / (detector.pixels.columns * detector.pixels.rows);
  return [=](const Photon& p) -> std::optional<PhotonScore> {
    const Vec3 from = p.x - detector.centre;
    const Vec3 normal =
        sphere_radius > 0 ? ((from + sphere_radius * outward) / sphere_radius).eval() : outward;
    if (sphere_radius > 0 ? normal.dot(outward) <= 0 : std::abs(from.dot(outward)) > 1e-6)
      return {};
    if (p.direction.dot(normal) < std::cos(detector.acceptance)) return {};
    const auto pixel = pixel_of(detector.pixels, from.dot(u), from.dot(v), detector.width / 2,
                                detector.height / 2);
    if (!pixel) return {};
    return PhotonScore{*pixel, normal.dot(outward) / pixel_area};
  };
}

PhotonSensor radial_sensor(const RadialDetector& detector, const Vec3& outward) {
  return [=](const Photon& p) -> std::optional<PhotonScore> {
    const Vec3 from = p.x - detector.centre;
    if (std::abs(from.dot(outward)) > 1e-6 || from.norm() >= detector.radius) return {};
    if (p.direction.dot(outward) < std::cos(detector.acceptance)) return {};
    const double width = detector.radius / detector.rings;
    const int ring = static_cast<int>(from.norm() / width);
    return PhotonScore{ring, 1 / (std::numbers::pi * width * width * (2 * ring + 1))};
  };
}

PhotonSensor polar_sensor(const PolarDetector& detector) {
  const Vec3 axis = detector.axis.normalized();
  return [=](const Photon& p) -> std::optional<PhotonScore> {
    const double width = detector.half_angle / detector.rings;
    const int ring = static_cast<int>(std::acos(p.direction.dot(axis)) / width);
    if (ring >= detector.rings) return {};
    const double solid_angle =
        2 * std::numbers::pi * (std::cos(ring * width) - std::cos((ring + 1) * width));
    return PhotonScore{ring, 1 / solid_angle};
  };
}

PhotonSensor directional_sensor(const DirectionalDetector& detector) {
  const Vec3 forward = detector.forward.normalized(), v = upright(detector.up, forward);
  const Vec3 u = forward.cross(v);
  const double half = std::sin(detector.half_angle);
  const double pixel_area = 4 * half * half / (detector.pixels.columns * detector.pixels.rows);
  return [=](const Photon& p) -> std::optional<PhotonScore> {
    const double cosine = p.direction.dot(forward);
    const auto pixel =
        pixel_of(detector.pixels, p.direction.dot(u), p.direction.dot(v), half, half);
    if (cosine <= 0 || !pixel) return {};
    return PhotonScore{*pixel, cosine / pixel_area};
  };
}

PhotonSensor lens_sensor(const Camera& camera) {
  const Vec3 forward = camera.forward.normalized(), v = upright(camera.up, forward);
  const Vec3 u = forward.cross(v);
  const double half = std::tan(camera.field_of_view / 2);
  const double half_v = half * camera.pixels.rows / camera.pixels.columns;
  const double pixel_area = 4 * half * half_v / (camera.pixels.columns * camera.pixels.rows);
  const double lens_area = std::numbers::pi * camera.lens_radius * camera.lens_radius;
  return [=](const Photon& p) -> std::optional<PhotonScore> {
    const Vec3 from = p.x - camera.x;
    const double cosine = -p.direction.dot(forward);
    if (from.norm() > camera.lens_radius || cosine <= 0) return {};
    const Vec3 focus = from / camera.focus_distance - p.direction / cosine;
    const auto pixel = pixel_of(camera.pixels, focus.dot(u), focus.dot(v), half, half_v);
    if (!pixel) return {};
    return PhotonScore{*pixel, 1 / (std::pow(cosine, 4) * pixel_area * lens_area)};
  };
}

PhotonPicture photon_picture(const TwoScenes& scenes, std::uint64_t most_photons,
                             std::uint64_t seed) {
  const double share = flatspeckle::tests::effort().samples;
  const auto photons = static_cast<std::uint64_t>(share * static_cast<double>(most_photons));
  const PixelGrid grid = pixels_of(scenes.scene.sensors[0]).grid;
  const TimeBins& bins = scenes.scene.bins;
  const std::size_t pixels = static_cast<std::size_t>(grid.columns) * grid.rows;
  PhotonTally tally(pixels * bins.count, photons), steady(pixels, photons);
  walk_photons(scenes.walk, scenes.source, photons, flatspeckle::tests::fresh_seed(seed),
               [&](const Photon& p) {
                 const auto seen = scenes.sensor(p);
                 if (!seen) return;
                 const std::size_t pixel = seen->pixel;
                 steady.add(pixel, seen->score);
                 if (bins.count == 1) return tally.add(pixel, seen->score);
                 if (p.optical_path < bins.first || p.optical_path > bins.last) return;
                 // split linearly between the two bins with the nearest centres
                 const double width = (bins.last - bins.first) / bins.count;
                 const double at =
                     std::clamp((p.optical_path - bins.first) / width - 0.5, 0.0, bins.count - 1.0);
                 const int before = std::min(static_cast<int>(at), bins.count - 2);
                 tally.add(pixel * bins.count + before, seen->score * (before + 1 - at));
                 tally.add(pixel * bins.count + before + 1, seen->score * (at - before));
               });
  PhotonPicture picture;
  for (std::size_t i = 0; i < tally.size(); ++i) {
    picture.value.push_back(scenes.power * tally.mean(i));
    picture.error.push_back(scenes.power * tally.error(i));
  }
  for (std::size_t i = 0; i < pixels; ++i) {
    picture.steady_value.push_back(scenes.power * steady.mean(i));
    picture.steady_error.push_back(scenes.power * steady.error(i));
  }
  return picture;
}

void check_against(const PhotonPicture& photons, const TwoScenes& scenes,
                   const RenderRequest& request, std::uint64_t samples, double precision) {
  const std::string method = request.method ? name(*request.method) : "auto";
  CAPTURE(method);
  const RenderJob job = render_job(scenes.scene, request, flatspeckle::tests::fresh_seed(11));
  const RunState state =
      run_render(job, flatspeckle::tests::effort().samples * static_cast<double>(samples));
  const RenderedPicture picture = rendered_picture(job, state.sums);
  check_all(picture.bins.value, picture.bins.error, photons.value, photons.error);
  if (scenes.scene.bins.count > 1)
    check_all(picture.steady.value, picture.steady.error, photons.steady_value,
              photons.steady_error);
  const Estimate mean = pixel_mean(job, state);
  double error = 0;
  for (double e : photons.steady_error) error = std::hypot(error, e);
  const auto entries = static_cast<double>(job.pictures);
  const Compared c{mean.value[0].real() * entries, mean.error[0] * entries,
                   total_of(photons.steady_value), error};
  CAPTURE(c.a);
  CAPTURE(c.a_error);
  CAPTURE(c.b);
  CAPTURE(c.b_error);
  CHECK(c.agree());
  CHECK(c.a_error < flatspeckle::tests::effort().errors * precision * c.a);
}

}  // namespace flatspeckle::grin::tests

#include <doctest/doctest.h>

#include "tests/grin/fisheye_curves.h"
#include "tests/grin/furnace.h"

namespace flatspeckle::grin::tests::test_single_scattering {

namespace {

using oracles::FisheyeCurves;

constexpr double n0 = 1.7;
const Vec3 light_at(0.5, 0.3, 0.2), camera_at(-0.2, 0.1, -0.9);
constexpr double field_of_view = 0.8;

double henyey_greenstein(double g, double cosine) {
  return (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

/// Returns the arc length along a circle up to `angle`, -1 if it leaves the ball.
double arc_length(const FisheyeCurves& curves, const FisheyeCurves::Circle& circle, double angle,
                  double ball) {
  constexpr int nodes = 60;
  double length = 0;
  for (int i = 0; i < nodes; ++i) {
    const Vec3 x = curves.point(circle.at((i + 0.5) / nodes * angle));
    if (x.norm() > ball) return -1;
    length += curves.radius() * angle / nodes / curves.index(x);
  }
  return length;
}

/// Returns the L/n^2 that light of power 1 at `light_at`, scattered once at x, sends along
/// `onwards`, per scattering coefficient: the sum over both arcs, from C25 and C27 by hand.
double scattered_at(const FisheyeCurves& curves, const ScatteringMedium& medium, double ball,
                    const Vec3& x, const Vec3& onwards) {
  double angle, sum = 0;
  FisheyeCurves::Circle circle = curves.circle_between(light_at, x, angle);
  for (const bool short_path : {true, false}) {
    if (!short_path) {
      circle.tangent = -circle.tangent;
      angle = 2 * std::numbers::pi - angle;
    }
    const double length = arc_length(curves, circle, angle, ball);
    if (length < 0) continue;
    const Vec3 arriving = curves.direction(circle.at(angle), circle.along(angle));
    const double r = curves.radius() * std::sin(angle);
    // n_x^2 |J| = R^2 sin^2
    sum += henyey_greenstein(medium.phase.mean_cosine(), arriving.dot(onwards)) *
           std::exp(-medium.mu_t() * length) / (4 * std::numbers::pi * r * r);
  }
  return sum;
}

double along_ray(const FisheyeCurves& curves, const ScatteringMedium& medium, double ball,
                 const Vec3& direction) {
  const auto ray = curves.circle(camera_at, direction);
  const double step = std::min(0.005, 0.02 / curves.radius());  // step of the angle
  double sum = 0, length = 0;
  for (double alpha = step / 2; alpha < 2 * std::numbers::pi; alpha += step) {
    const Vec3 x = curves.point(ray.at(alpha));
    if (x.norm() > ball) break;
    const double ds = curves.radius() * step / curves.index(x);
    const Vec3 onwards = -curves.direction(ray.at(alpha), ray.along(alpha));
    sum += medium.mu_s * std::exp(-medium.mu_t() * (length + ds / 2)) * ds *
           scattered_at(curves, medium, ball, x, onwards);
    length += ds;
  }
  return sum;
}

/// Returns the mean over the only pixel of the camera, which faces +z with y up.
double single_scattering(const FisheyeCurves& curves, const ScatteringMedium& medium, double ball) {
  constexpr int nodes = 8;
  const double half = std::tan(field_of_view / 2);
  double sum = 0;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j) {
      const auto at = [&](int k) { return half * ((2 * k + 1.0) / nodes - 1); };
      sum += along_ray(curves, medium, ball, Vec3(at(i), at(j), 1).normalized());
    }
  return sum / (nodes * nodes);
}

RenderScene scene(const AnyIndexField& field, const ScatteringMedium& medium, double ball) {
  return scene_in(field, {Sphere{Vec3::Zero(), ball}, medium}, PointLight{light_at},
                  Camera{camera_at, Vec3::UnitZ(), Vec3::UnitY(), field_of_view, {1, 1}});
}

void check_single(const RenderScene& scene, double expected, double samples) {
  for (const RenderMethod method : unbiased_methods) {
    const double share = method == RenderMethod::bidirectional ? 0.5 : 1;
    const Rendered result =
        rendered(scene, {.method = method, .max_scatterings = 1}, samples * share);
    CAPTURE(name(method));
    CAPTURE(result.error() / expected);
    CHECK(std::abs(result.value() - expected) < 4 * result.error() + 2e-3 * expected);
    CHECK(result.error() < (method == RenderMethod::light ? 0.15 : 0.03) * expected);
  }
}

}  // namespace

TEST_CASE("single scattering along straight rays: agrees with quadrature") {
  const ScatteringMedium medium = fog(0.6, 0.2, 0.5);
  // a fisheye so wide that it is homogeneous, to 1e-4
  const double expected = single_scattering({n0, 150}, medium, 1.5);
  check_single(scene(Homogeneous{n0 - 1}, medium, 1.5), expected, 1e5);
}

TEST_CASE("single scattering in a fisheye: agrees with quadrature") {
  const ScatteringMedium medium = fog(0.6, 0.2, 0.5);
  const double a = 2;
  const double expected = single_scattering({n0, a}, medium, 1.2);
  check_single(scene(Fisheye({.centre_excess = n0 - 1, .radius = a}), medium, 1.2), expected, 1e5);
}

TEST_CASE("single scattering with two curves between many points: agrees with quadrature") {
  const ScatteringMedium medium = fog(0.2, 0.05, 0.3);
  const double a = 1, ball = 1.5;
  const double expected = single_scattering({n0, a}, medium, ball);
  const Fisheye fisheye({.centre_excess = n0 - 1, .radius = a});
  AnySum by_search;  // a sum has no closed forms
  by_search.add(fisheye);
  for (const AnyIndexField& field : {AnyIndexField(fisheye), AnyIndexField(by_search)}) {
    const bool is_searched = field.index() == AnyIndexField(by_search).index();
    CAPTURE(is_searched);
    const Rendered result =
        rendered(scene(field, medium, ball), {.method = RenderMethod::path, .max_scatterings = 1},
                 is_night ? 1e5 : 6e3);
    CAPTURE(result.error() / expected);
    CHECK(std::abs(result.value() - expected) < 4 * result.error());
    CHECK((result.counts.connections.mean_trials() > 1.05) == is_searched);
  }
}

}  // namespace flatspeckle::grin::tests::test_single_scattering

// Rays that turn back, graze, focus and are followed over long distances.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "bench/oracles/harmonic_ball.h"
#include "bench/scenes/random_fields.h"
#include "bench/stability/extreme_rows.h"
#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/linear_ramp.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/sech.h"
#include "grin/media/fields/tanh_ramp.h"
#include "grin/media/fields/ultrasound.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/rays/marching/ray_invariants.h"
#include "grin/rays/marching/trace.h"
#include "grin/trace/trace_scene.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;
using oracles::HarmonicBall;
using oracles::HarmonicCurve;
using std::numbers::pi;
const std::vector<Surface> nothing;
const ParabolicGuide guide({0.5, 1});  // the index is undefined beyond rho = 1.5

ControlledSteps<Sharma> controlled(double tolerance, double longest) {
  return {tolerance, 0.01, longest};
}

/// Checks a ray from the plane of a beam to the focus on the far rim of a Luneburg lens: its
/// position, and its optical path pi/2 + 1.
Finding luneburg(double height, double limit) {
  const Luneburg lens{LuneburgProfile{1, 0.3}};
  const std::vector<Surface> rim{Sphere{}};
  const TraceLimits limits{1e3, 1e-12};
  FixedSteps<Leapfrog> straight{1};
  auto steps = controlled(1e-12, 1);
  RayState ray = start_ray(Homogeneous{}, {-1, height, 0}, Vec3::UnitX());
  if (height > 0) trace(Homogeneous{}, rim, limits, straight, ray);
  const TraceEnd end = trace(lens, rim, limits, steps, ray);
  if (end.stop != Stop::surface) return yes(false);
  return {larger((ray.x - Vec3::UnitX()).norm(), std::abs(ray.optical_path - (pi / 2 + 1))), limit};
}

Finding beside_the_rim() {
  const std::vector<Surface> rim{Sphere{}};
  FixedSteps<Leapfrog> straight{1};
  RayState ray = start_ray(Homogeneous{}, {-1, 1 + 1e-9, 0}, Vec3::UnitX());
  const TraceEnd end = trace(Homogeneous{}, rim, {2, 1e-12}, straight, ray);
  return {end.stop == Stop::length ? (ray.x - Vec3(1, 1 + 1e-9, 0)).norm() : 1, 1e-15};
}

/// Checks a ray on a circle of radius 1/sin(angle) through a point of the unit sphere and its
/// image. Far from the centre the index is about angle^2/4. The position and the optical path pi n0
/// a / 2 are checked. Far from the centre, where n is small, n = 1 + excess is rounded to 2^-53 at
/// each of nine evaluations per step; the resulting errors of v^2 - n^2 are amplified as the ray
/// returns towards the centre.
Finding ray_far_out(double angle) {
  const Fisheye eye(FisheyeProfile{0.5, 1});
  auto steps = controlled(1e-12, 1e9);
  const Vec3 start = Vec3(1, 2, 2) / 3, across = Vec3(2, 1, -2) / 3;
  RayState ray = start_ray(eye, start, std::cos(angle) * start + std::sin(angle) * across);
  const double arc = 2 * (pi - angle) / std::sin(angle);
  const TraceEnd end = trace(eye, nothing, {arc, 1e-11 * arc}, steps, ray);
  if (end.stop != Stop::length) return yes(false);
  const double looks = 9 * static_cast<double>(end.steps),
               rounded = looks * std::ldexp(4 / (angle * angle), -53);
  return {larger((ray.x + start).norm(), std::abs(ray.optical_path - pi * 0.75)),
          1e-9 / angle + rounded};
}

/// Checks a ray in the index n = 1.5 + gradient z, up to its turning point and back to the start: n
/// = n0 cosh(gradient sigma) + v_z sinh(gradient sigma), x = v_x sigma.
Finding turning_point(double gradient, double cosine) {
  const LinearRamp ramp{0.5, Vec3(0, 0, gradient)};
  const RayState start = start_ray(ramp, Vec3::Zero(), {std::sqrt(1 - cosine * cosine), 0, cosine});
  const double sigma = cosine > 0 ? -2 * std::atanh(start.v[2] / 1.5) / gradient : -1 / gradient;
  RayState ray = start;
  constexpr int count = 2000;
  for (int i = 0; i < count; ++i) Sharma::step(ramp, ray, sigma / count);
  const double along = gradient * sigma;
  const double n = 1.5 * std::cosh(along) + start.v[2] * std::sinh(along);
  const double size = std::abs(1 / gradient);
  return {larger({std::abs(ray.x[0] - start.v[0] * sigma) / size,
                  std::abs(ray.x[2] - (n - 1.5) / gradient) / size,
                  std::abs(index(ramp, ray.x) - ray.v.norm())}),
          1e-11};
}

/// Checks rays 1e-8 on either side of the critical angle, and the angle of a transmitted ray.
Finding critical_angle(double width) {
  const double n1 = 1.5, n2 = 1.2;
  const TanhRamp ramp{n1 - 1, n2 - 1, width};
  const std::vector<Surface> ends{Plane{{0, 0, -20 * width}, -Vec3::UnitZ()},
                                  Plane{{0, 0, 20 * width}, Vec3::UnitZ()}};
  auto steps = controlled(1e-11, width);
  const auto passes = [&](double sine, RayState& ray) {
    ray = start_ray(ramp, {0, 0, -19 * width}, {sine, 0, std::sqrt(1 - sine * sine)});
    const TraceEnd end = trace(ramp, ends, {1e6 * width, 1e-9 * width, 500'000}, steps, ray);
    return end.stop == Stop::surface && end.surface == 1;
  };
  RayState ray;
  const bool right = passes(n2 / n1 * (1 - 1e-8), ray) && !passes(n2 / n1 * (1 + 1e-8), ray);
  if (!right || !passes(0.5, ray)) return yes(false);
  return {std::abs(ray.v[0] / ray.v.norm() - 0.5 * n1 / n2), 1e-8};
}

/// Checks that |v| - n stays bounded over 1e4 oscillations of 40 steps each, because the integrator
/// is symplectic, and that the component of v along the guide is conserved exactly.
Finding guide_index() {
  RayState ray = start_ray(guide, {0.5, 0, 0}, {0.1, 0.3, 1});
  const double along = ray.v[2];
  double worst = 0;
  for (int i = 0; i < 400'000; ++i) {
    Yoshida4::step(guide, ray, 2 * pi / 40);
    worst = larger(worst, std::abs(ray_invariants(guide, ray).index_mismatch));
  }
  return ray.v[2] == along ? Finding{worst, 2e-5} : yes(false);
}

/// Checks the position after 1e4 oscillations of 400 steps each. The phase error is 0.1 h^4 per
/// radian for steps of h.
Finding guide_phase() {
  RayState ray = start_ray(guide, {0.5, 0, 0}, {0.1, 0.3, 1});
  const RayState start = ray;
  const double h = 2 * pi / 400;
  constexpr int count = 4'000'000;
  for (int i = 0; i < count; ++i) Yoshida4::step(guide, ray, h);
  const double off = (ray.x - start.x - Vec3(0, 0, start.v[2] * h * count)).norm();
  return {off, 0.1 * std::pow(h, 4) * h * count};
}

/// Checks that a ray returns to its start when followed over 1e4 oscillations and back.
Finding guide_and_back() {
  RayState ray = start_ray(guide, {0.5, 0, 0}, {0.1, 0.3, 1});
  const RayState start = ray;
  for (const double h : {2 * pi / 40, -2 * pi / 40})
    for (int i = 0; i < 400'000; ++i) Yoshida4::step(guide, ray, h);
  // z grows to 6e4 and is rounded 8e5 times
  return {larger((ray.x - start.x).norm(), (ray.v - start.v).norm()), 1e-8};
}

/// Compares dx/dv0 across the guide with sin(sigma) after 100 oscillations and a quarter.
Finding guide_tangent() {
  RayState ray = start_ray(guide, {0.3, 0, 0}, {0.1, 0.2, 1});
  RayTangent tangent;
  const double h = 2 * pi / 400;
  constexpr int count = 40'100;
  for (int i = 0; i < count; ++i) Yoshida4::step(guide, ray, tangent, h);
  Mat3 exact = Mat3::Identity();
  exact(2, 2) = h * count;
  return {(tangent.dx - exact).norm(), 0.1 * std::pow(h, 4) * h * count};
}

/// Checks a ray in a guide of period 2 pi 1e4, whose optical path exceeds the length by a fraction
/// of 1e-7.
Finding ray_in_faint_guide() {
  const ParabolicGuide faint({1e-6, 1e-4});
  RayState ray = start_ray(faint, {0.3, 0, 0}, Vec3::UnitZ());
  const double beta = ray.v[2], sigma = 1.25 * 2 * pi / 1e-4, n0 = 1 + 1e-6;
  for (int i = 0; i < 1000; ++i) Yoshida4::step(faint, ray, sigma / 1000);
  const double path = beta * sigma * (n0 * n0 + beta * beta) / (2 * beta);
  return {larger({std::abs(ray.x[0]) / 0.3, std::abs(ray.v[0] / -0.3e-4 - 1),
                  std::abs(ray.optical_path / path - 1) * 1e7}),
          1e-7};
}

/// Checks that all rays have the same optical path, n0 times the length, for every tilt, over 1000
/// half periods.
Finding sech_dispersion() {
  const double n0 = 1.5, alpha = 0.6, length = 1000 * pi / alpha;
  const SechGuide sech({n0 - 1, alpha});
  const std::vector<Surface> end{Plane{{0, 0, length}, Vec3::UnitZ()}};
  double worst = 0;
  for (const double tilt : {0.0, 0.3, 0.8}) {
    ControlledSteps<Yoshida4> steps{1e-12, 0.01, 1};
    RayState ray = start_ray(sech, Vec3::Zero(), {tilt * 0.6, tilt * 0.8, 1});
    if (trace(sech, end, {1e5, 1e-9}, steps, ray).stop != Stop::surface) return yes(false);
    worst = larger(worst, std::abs(ray.optical_path / (n0 * length) - 1));
  }
  return {worst, 1e-9};
}

/// Checks a ray at coordinates of 1e8, which are rounded to 1e-8. The step control must not reduce
/// steps because of this rounding.
Finding far_from_origin() {
  const double start = 1e8;
  const std::vector<Surface> end{Plane{{0, 0, start + 10}, Vec3::UnitZ()}};
  auto steps = controlled(1e-11, 1);
  RayState ray = start_ray(guide, {0, 0, start}, {0.2, 0, 1});
  const Vec3 v = ray.v;
  if (trace(guide, end, {20, 1e-14 * start}, steps, ray).stop != Stop::surface) return yes(false);
  return {std::abs(ray.x[0] - v[0] * std::sin(10 / v[2])), 1e-6};
}

struct TracedBeam {
  RayState end;
  double spreading;
  int caustics;
};
template <grin::IndexField F>
TracedBeam beam(const F& field, RayState ray, double sigma, int steps) {
  const RayState start = ray;
  RayTangent tangent;
  CausticCount caustics(start.v.norm(), start.v);
  for (int i = 0; i < steps; ++i) {
    Sharma::step(field, ray, tangent, sigma / steps);
    caustics.pass(ray, tangent);
  }
  return {ray, signed_spreading(tangent, start.v.norm(), start.v, ray.v), caustics.count()};
}

/// Checks a beam in the harmonic ball: |J| = n0^2 sin^2 sigma (v0.v) has second-order zeros at its
/// foci. At a distance of 1e-6 from a focus, positions accurate to 1e-13 give |J| to 1e-7.
Finding ball_focus(double beyond) {
  const HarmonicBall field{{}};
  const RayState start = start_ray(field, {0.3, 0.2, -0.4}, {0.5, -0.3, 0.6});
  const HarmonicCurve exact{start.x, start.v, pi + beyond};
  const TracedBeam found = beam(field, start, exact.sigma, 3000);
  if (beyond == 0) return {std::abs(found.spreading), 1e-20};
  if (found.caustics != exact.caustics()) return yes(false);
  return {std::abs(std::abs(found.spreading) / exact.spreading() - 1), 1e-6};
}

/// Checks a beam at the image point of a fisheye, where both of its widths vanish.
Finding fisheye_focus() {
  const double n0 = 1.7, a = 0.8;
  const Fisheye field({n0 - 1, a});
  const Vec3 from(0.3, 0.2, -0.4);
  auto steps = controlled(1e-12, 0.01);
  RayState ray = start_ray(field, from, {0.1, 0.9, 0.3});
  const RayState start = ray;
  RayTangent tangent;
  const auto left = [&] { return pi * n0 * a / 2 - ray.optical_path; };
  while (left() > 0.02) steps.advance(field, ray, tangent);
  for (int newton = 0; newton < 10; ++newton)
    for (int part = 0, parts = 10; part < parts; ++part)
      Sharma::step(field, ray, tangent, left() / (parts - part) / ray.v.squaredNorm());
  const Vec3 image = -a * a / from.squaredNorm() * from;
  return {larger((ray.x - image).norm(),
                 std::abs(signed_spreading(tangent, start.v.norm(), start.v, ray.v))),
          1e-8};
}

/// Checks a quarter period of a ray 1e-6 off the axis of the sound field, which equals the guide of
/// C28 up to relative terms of (kr rho)^2 / 16.
Finding sound_axis() {
  const double n0 = 1.33, sound = 1e-3, kr = 7, off = 1e-6;
  const StandingWave wave(n0 - 1, sound, 0, kr, 2);
  const double alpha = std::sqrt((n0 + sound) * sound * kr * kr / 2), sigma = pi / (2 * alpha);
  RayState ray = start_ray(wave, {off, 0, 0}, Vec3::UnitZ());
  RayState axis = start_ray(wave, Vec3::Zero(), Vec3::UnitZ());
  for (int i = 0; i < 1000; ++i) {
    Yoshida4::step(wave, ray, sigma / 1000);
    Yoshida4::step(wave, axis, sigma / 1000);
  }
  return {larger({std::abs(ray.x[0]) / off, std::abs(ray.v[0] / (off * alpha) + 1),
                  std::hypot(axis.x[0], axis.x[1])}),
          1e-9};
}

/// Checks rays in n = 1 - z: a ray along z approaches z = 1 asymptotically; an oblique ray turns
/// back before.
Finding ray_without_index() {
  const LinearRamp ramp{0, {0, 0, -1}};
  auto careful = controlled(1e-10, 1);
  RayState up = start_ray(ramp, Vec3::Zero(), Vec3::UnitZ());
  const bool lost = trace(ramp, nothing, {1e3, 1e-11}, careful, up).stop == Stop::lost;
  auto again = controlled(1e-10, 1);
  RayState aside = start_ray(ramp, Vec3::Zero(), {1e-3, 0, 1});
  const TraceEnd back = trace(ramp, nothing, {1.5, 1e-11}, again, aside);
  return yes(lost && back.stop == Stop::length && aside.v[2] < 0);
}

Finding beyond_the_guide() {
  FixedSteps<Sharma> wide{2};
  RayState out{{1, 0, 0}, {3, 0, 1}};
  return yes(trace(guide, nothing, {1e3, 1e-11}, wide, out).stop == Stop::lost);
}

/// Checks a ray beyond the range of a sound wave of order 64. The wave is computed as (kr rho)^64
/// times a profile, which is tabulated up to kr rho = 1e4.
Finding sound_too_far() {
  const StandingWave wave(0.3, 0.01, 64, 7, 70);
  auto steps = controlled(1e-10, 1);
  RayState ray = start_ray(wave, {1e5 / 7, 0, 0}, Vec3::UnitZ());
  return yes(trace(wave, nothing, {10, 1e-9}, steps, ray).stop == Stop::lost);
}

/// Traces a ray through bodies, to z = 2 or a length of 10.
RayState through(const PlainBodyValues& bodies, const Vec3& from, const Vec3& towards) {
  TraceValues values;
  values.bodies.plain_bodies = bodies;
  values.starts.origin = {from[0], from[1], from[2]};
  values.starts.direction = {towards[0], towards[1], towards[2]};
  values.starts.across = {0, 1, 0};
  values.starts.ray_count = 1;
  values.stops.stop_plane = {0, 0, 2, 0, 0, 1};
  values.stops.max_length = 10;
  return trace_rays(make_trace_scene(values))[0].end;
}

/// Checks a ball lens: a ray at height h is refracted twice and deflected by 2 (asin h - asin h/n).
Finding ball_lens(double height, double excess, double limit) {
  const RayState end =
      through({.ball = {0, 0, 0, 1, 1 + excess, 0, 0, 0}}, {height, 0, -2}, Vec3::UnitZ());
  const double turn = 2 * (std::asin(height) - std::asin(height / (1 + excess)));
  return {std::abs(std::atan2(-end.v[0], end.v[2]) / turn - 1), limit};
}

/// Checks a ray inside a plate at the critical angle + `beyond`: it must leave through the other
/// side or be totally reflected.
Finding at_critical_angle(double beyond) {
  const double angle = std::asin(1 / 1.5) + beyond;
  const RayState end = through({.block = {-1e6, -1e6, 0, 1e6, 1e6, 1, 1.5, 0, 0, 0}}, {0, 0, 0.5},
                               {std::sin(angle), 0, std::cos(angle)});
  const bool is_inside = std::abs(end.v.norm() - 1.5) < 1e-9;
  return yes(is_inside == (beyond > 0));
}

/// Checks that a lens face of large radius R deflects a ray at height 1 by (n - 1)/R.
Finding weak_lens(double radius) {
  const RayState end =
      through({.lens = {0, 0, 0, 2, radius, 0, 0.5, 1.5, 0, 0, 0}}, {1, 0, -1}, Vec3::UnitZ());
  return {std::abs(-end.v[0] * radius / 0.5 - 1), 1e-16 * radius + 1 / (radius * radius)};
}

/// Checks a lens with a radius so large that the deflection is below double precision.
Finding flat_lens(double radius) {
  const RayState end =
      through({.lens = {0, 0, 0, 2, radius, 0, 0.5, 1.5, 0, 0, 0}}, {1, 0, -1}, Vec3::UnitZ());
  return {std::abs(end.v[0]) + std::abs(end.x[0] - 1), 1e-15};
}

/// Checks an oblique ray through two plates separated by `gap`: it is displaced by the sum of d
/// tan(angle) over plates and gap of thickness d.
Finding plates_in_contact(double gap) {
  const double s = 0.6;
  const RayState end = through({.block = {-1e3, -1e3, -1,  1e3, 1e3, 0, 1.5, 0, 0, 0,  //
                                          -1e3, -1e3, gap, 1e3, 1e3, 1, 2,   0, 0, 0}},
                               {0, 0, -2}, {s, 0, std::sqrt(1 - s * s)});
  const auto aside = [&](double thickness, double index) {
    return thickness * s / std::sqrt(index * index - s * s);
  };
  const double expected = aside(2 + gap, 1) + aside(1, 1.5) + aside(1 - gap, 2);
  return {std::abs(end.x[0] - expected) / std::abs(expected) + std::abs(end.v[0] - s), 1e-13};
}

void add_bodies(ExtremeRows& rows) {
  rows.add_each("ball of glass, beam at height ", {1e-9, 0.7, 1 - 1e-9}, "",
                "angle it is turned by", ball_lens, 0.5, 1e-7);
  rows.add("ball of n - 1 = 1e-9", "angle it is turned by", ball_lens, 0.7, 1e-9, 1e-6);
  rows.add_each("plate, ", {-1e-12, 1e-12}, " beyond the critical angle",
                "leaves, or stays for ever", at_critical_angle);
  for (const double radius : {1e3, 1e9})
    rows.add("lens of a face of radius " + short_number(radius), "angle it is turned by", weak_lens,
             radius);
  for (const double radius : {1e17, 1e50})
    rows.add("lens of a face of radius " + short_number(radius), "passes straight", flat_lens,
             radius);
  for (const double gap : {0.0, 1e-16, 1e-12, 1e-9, 1e-3})
    rows.add("two plates, gap " + short_number(gap), "Snell, sideways", plates_in_contact, gap);
}

void add_lenses(ExtremeRows& rows) {
  rows.add_each("Luneburg lens, beam at height ", {0.0, 0.7, 0.999}, "", "focus, optical path",
                luneburg, 1e-10);
  // the ray meets the rim at 4e-5 rad; the rim is located to 1e-12 along its normal and therefore
  // to 2e-8 along the ray
  rows.add("Luneburg lens, beam at height 1 - 1e-9, rim grazed", "focus, optical path", luneburg,
           1 - 1e-9, 1e-7);
  rows.add("Luneburg lens, beam at height 1 + 1e-9", "passes straight", beside_the_rim);
  for (const double angle : {0.02, 0.002, 0.0002})
    rows.add("fisheye, circle of " + short_number(1 / angle) + " radii", "image, optical path",
             ray_far_out, angle);
  rows.add("fisheye, beam from a point to its image", "image, |J| = 0", fisheye_focus);
  rows.add_each("caustic of Luneburg's ball, ", {0.0, -1e-6, 1e-6, 1e-3}, " beyond sigma = pi",
                "|J|, caustics passed", ball_focus);
}

void add_ramps(ExtremeRows& rows) {
  rows.add_each("turning point, slope ", {-1e-6, -1.0, -1e6}, "", "catenary", turning_point, 0.6);
  rows.add("turning point, at exactly pi/2", "catenary", turning_point, -1, 0);
  rows.add_each("ramp of width ", {1e-3, 1e-6}, ", 1e-8 about the critical angle",
                "passes or turns, Snell", critical_angle);
  rows.add("ramp where n falls to 0", "lost, or turned back", ray_without_index);
  rows.add("ultrasound of order 64 at kr rho = 1e5: (kr rho)^64 is no number", "lost",
           sound_too_far);
  rows.add("step beyond the index of a guide", "lost", beyond_the_guide);
}

void add_guides(ExtremeRows& rows) {
  rows.add("guide, 1e4 oscillations, 40 steps each", "|v| - n, v along", guide_index);
  rows.add_slow("guide, 1e4 oscillations, 400 steps each", "place in closed form", guide_phase);
  rows.add("guide, 1e4 oscillations and back", "place, direction", guide_and_back);
  rows.add("guide, tangent of 100 oscillations", "dx/dv0 in closed form", guide_tangent);
  rows.add("guide of n - 1 = 1e-6, period 6e4", "place, slope, path beyond length",
           ray_in_faint_guide);
  rows.add_slow("sech guide, 1000 half periods, slopes to 0.8", "optical path n0 L",
                sech_dispersion);
  rows.add("guide at coordinates of 1e8", "place in closed form", far_from_origin);
  rows.add("axis of ultrasound, and 1e-6 beside it", "guide of C28", sound_axis);
}

}  // namespace

void ray_extremes(ExtremeRows& rows) {
  add_lenses(rows);
  add_bodies(rows);
  add_ramps(rows);
  add_guides(rows);
}

}  // namespace flatspeckle::bench

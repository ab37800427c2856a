// Errors and measured orders of the ray integrators against closed forms, what they keep over long
// guides, and extreme cases: n nearly 0, the critical angle of a steep ramp, modal dispersion.
// usage: bench_ray_orders
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <vector>

#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/sech.h"
#include "grin/media/fields/tanh_ramp.h"
#include "grin/rays/marching/ray_invariants.h"
#include "grin/rays/marching/trace.h"

using namespace flatspeckle::grin;

namespace {

constexpr double pi = std::numbers::pi;

struct Errors {
  double position, direction, path;
};

// From the rim to the focus of a Luneburg lens, at height 0.6.
template <class Integrator>
Errors luneburg(int steps) {
  const Luneburg lens{LuneburgProfile{}};
  const Vec3 start(-0.8, 0.6, 0);
  RayState ray = start_ray(lens, start, Vec3::UnitX());
  for (int i = 0; i < steps; ++i) Integrator::step(lens, ray, pi / 2 / steps);
  return {(ray.x - Vec3::UnitX()).norm(), (ray.v + start).norm(),
          std::abs(0.2 + ray.optical_path - (pi / 2 + 1))};
}

// From a point to its image in a fisheye, the long way round a circle that is off its centre.
template <class Integrator>
Errors fisheye(int steps) {
  const Fisheye eye{FisheyeProfile{0.5, 1}};
  const double angle = 1.1, radius = 1 / std::sin(angle), offset = 1 / std::tan(angle);
  // dsigma = ds (1 + r^2)/n0 along the arc of angle `turn`, r^2 = R^2 + d^2 + 2 R d cos.
  const double turn = 2 * (pi - angle), mean = 1 + radius * radius + offset * offset;
  const double sigma = radius / 1.5 * (mean * turn + 4 * radius * offset * std::sin(turn / 2));
  RayState ray = start_ray(eye, Vec3::UnitY(), {std::sin(angle), std::cos(angle), 0});
  for (int i = 0; i < steps; ++i) Integrator::step(eye, ray, sigma / steps);
  const Vec3 end = index(eye, -Vec3::UnitY()) * Vec3(-std::sin(angle), std::cos(angle), 0);
  return {(ray.x + Vec3::UnitY()).norm(), (ray.v - end).norm(),
          std::abs(ray.optical_path - 0.75 * pi)};
}

using Scene = Errors (*)(int);

void print_orders(const char* scene, const char* integrator, int order, Scene run) {
  for (const int steps : {50, 100, 200, 400}) {
    const Errors here = run(steps), finer = run(2 * steps);
    std::printf("%-10s %-10s %5d %6d   %9.2e %5.2f   %9.2e %5.2f   %9.2e %5.2f\n", scene,
                integrator, order, steps, here.position, std::log2(here.position / finer.position),
                here.direction, std::log2(here.direction / finer.direction), here.path,
                std::log2(here.path / finer.path));
  }
}

template <class Integrator>
void print_guide(const char* name, int periods) {
  const ParabolicGuide guide{ParabolicProfile{0.5, 1}};
  RayState ray = start_ray(guide, {0.5, 0, 0}, {0.1, 0.3, 1});
  const RayInvariants first = ray_invariants(guide, ray);
  // x + i v_x turns by -sigma; the phase that a period lacks is small, the sum over all need not
  // be.
  const auto turning = [&] { return std::complex(ray.x[0], ray.v[0]); };
  double mismatch = 0, phase = 0;
  for (int period = 0; period < periods; ++period) {
    const std::complex<double> before = turning();
    for (int i = 0; i < 40; ++i) {
      Integrator::step(guide, ray, 2 * pi / 40);
      mismatch = std::max(mismatch, std::abs(ray_invariants(guide, ray).index_mismatch));
    }
    phase += std::arg(turning() / before);
  }
  const RayInvariants last = ray_invariants(guide, ray);
  std::printf("%-10s %8d   %9.2e   %9.2e   %9.2e   %9.2e\n", name, periods, mismatch,
              std::abs(last.axial_momentum - first.axial_momentum),
              std::abs(last.axial_rotation - first.axial_rotation), std::abs(phase));
}

void print_far_fisheye(double angle) {
  const Fisheye eye{FisheyeProfile{0.5, 1}};
  RayState ray = start_ray(eye, Vec3::UnitY(), {std::sin(angle), std::cos(angle), 0});
  const double arc = 2 * (pi - angle) / std::sin(angle);
  ControlledSteps<Sharma> steps{1e-12, 1e-3, 1e9};
  const TraceEnd end = trace(eye, {}, {arc, 1e-12 * arc}, steps, ray);
  std::printf("%9.1e   %9.1e   %8ld   %9.2e   %9.2e\n", 1 / std::tan(angle / 2),
              1.5 * std::pow(std::sin(angle / 2), 2), end.steps, (ray.x + Vec3::UnitY()).norm(),
              std::abs(ray.optical_path - 0.75 * pi));
}

// Which sine of the angle in n = 1.5 still passes a ramp to n = 1.2, by bisection; Snell: 0.8.
void print_ramp(double width) {
  const TanhRamp ramp{0.5, 0.2, width};
  const std::vector<Surface> ends{Plane{{0, 0, -20 * width}, -Vec3::UnitZ()},
                                  Plane{{0, 0, 20 * width}, Vec3::UnitZ()}};
  double passes = 0.7, turns = 0.9;
  long steps_made = 0;
  while (turns - passes > 1e-12) {
    const double sine = (passes + turns) / 2;
    RayState ray = start_ray(ramp, {0, 0, -19 * width}, {sine, 0, std::sqrt(1 - sine * sine)});
    ControlledSteps<Sharma> steps{1e-12, width / 10, width};
    const TraceEnd end = trace(ramp, ends, {1e6 * width, 1e-9 * width}, steps, ray);
    steps_made = end.steps;
    (end.surface == 1 ? passes : turns) = sine;
  }
  std::printf("%9.1e   %8ld   %9.2e\n", width, steps_made, std::abs(passes / 0.8 - 1));
}

// Optical path over five half periods, per length, for a meridional ray at this slope on the axis.
template <IndexField F>
void print_dispersion(const char* name, const F& guide, double slope) {
  RayState ray = start_ray(guide, Vec3::Zero(), {slope * 0.6, slope * 0.8, 1});
  const bool is_parabolic = std::same_as<F, ParabolicGuide>;
  const double n0 = 1.5, alpha = 0.6, beta = ray.v[2];
  const double length = 5 * pi / alpha * (is_parabolic ? beta : 1);
  const std::vector<Surface> end{Plane{{0, 0, length}, Vec3::UnitZ()}};
  ControlledSteps<Yoshida4> steps{1e-12, 1e-3, 1};
  trace(guide, end, {1e3, 1e-12}, steps, ray);
  const double exact = is_parabolic ? (n0 * n0 + beta * beta) / (2 * beta) : n0;
  std::printf("%-10s %6.2f   %13.10f   %9.2e\n", name, slope, ray.optical_path / length,
              std::abs(ray.optical_path / length - exact));
}

}  // namespace

int main() {
  std::puts("Errors, and orders between these steps and twice as many");
  std::puts(
      "scene      integrator order  steps    position order   direction order        path order");
  print_orders("luneburg", "leapfrog", Leapfrog::order, luneburg<Leapfrog>);
  print_orders("luneburg", "yoshida4", Yoshida4::order, luneburg<Yoshida4>);
  print_orders("luneburg", "sharma", Sharma::order, luneburg<Sharma>);
  print_orders("fisheye", "leapfrog", Leapfrog::order, fisheye<Leapfrog>);
  print_orders("fisheye", "yoshida4", Yoshida4::order, fisheye<Yoshida4>);
  print_orders("fisheye", "sharma", Sharma::order, fisheye<Sharma>);

  std::puts("\nParabolic guide, 40 steps a period: worst | |v| - n |, errors of v_z, L_z, phase");
  std::puts("integrator  periods    mismatch         v_z         L_z       phase");
  for (const int periods : {1000, 10000}) {
    print_guide<Leapfrog>("leapfrog", periods);
    print_guide<Yoshida4>("yoshida4", periods);
    print_guide<Sharma>("sharma", periods);
  }

  std::puts("\nFisheye far out, controlled Sharma at 1e-12: from a point to its image");
  std::puts("far radius     least n      steps    position        path");
  for (const double angle : {1.0, 0.1, 0.01, 0.001}) print_far_fisheye(angle);

  std::puts("\nCritical angle of a tanh ramp from n = 1.5 to 1.2, controlled Sharma at 1e-12");
  std::puts("    width      steps   off Snell, relative");
  for (const double width : {1e-1, 1e-2, 1e-3}) print_ramp(width);

  std::puts("\nOptical path per length of guides, n0 = 1.5, controlled Yoshida4 at 1e-12");
  std::puts("guide       slope      path/length       error");
  for (const double slope : {0.0, 0.05, 0.3, 0.8})
    print_dispersion("sech", SechGuide(SechProfile{0.5, 0.6}), slope);
  for (const double slope : {0.0, 0.05, 0.3, 0.8})
    print_dispersion("parabolic", ParabolicGuide(ParabolicProfile{0.5, 0.6}), slope);
}

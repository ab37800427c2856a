// Errors and measured orders of the ray integrators against closed forms, and what they keep over
// long guides. usage: bench_ray_orders
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <string>

#include "grin/guides.h"
#include "grin/lenses.h"
#include "grin/ray_invariants.h"
#include "grin/trace.h"

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
}

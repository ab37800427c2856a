// Leapfrog steps per second and thread through a Bessel mode of sound, beside the same loop with a
// field that costs a few multiplications (the floor of arithmetic; nothing here comes from memory),
// and with the C library's Bessel functions. Interleaved; medians. usage: bench_ray_speed [rounds]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "bench/measure/median.h"
#include "core/numbers/random.h"
#include "core/run/stopwatch.h"
#include "grin/fields/focused_sound.h"
#include "grin/fields/spline_field.h"
#include "grin/fields/ultrasound.h"
#include "grin/rays/ray_step.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;

namespace {

constexpr int rays = 256, steps = 400;
constexpr double wavenumber = 7, radius = 1, step = 0.01;  // kr rho up to about 14

// Quartic in rho: what leapfrog itself costs.
struct QuarticField {
  double excess(const Vec3& x) const { return gradient(x).excess; }
  IndexGradient gradient(const Vec3& x) const {
    const double u = x[0] * x[0] + x[1] * x[1], slope = -0.2 + 0.02 * u;
    return {0.33 + u * (-0.1 + 0.005 * u), Vec3(slope * x[0], slope * x[1], 0)};
  }
  IndexHessian hessian(const Vec3&) const { return {}; }
};

// J_0 by the C library.
struct LibraryField {
  double excess(const Vec3& x) const { return gradient(x).excess; }
  IndexGradient gradient(const Vec3& x) const {
    const double rho = std::hypot(x[0], x[1]), z = wavenumber * rho;
    const double slope = rho > 0 ? -0.01 * wavenumber * ::j1(z) / rho : 0;
    return {0.33 + 0.01 * ::j0(z), Vec3(slope * x[0], slope * x[1], 0)};
  }
  IndexHessian hessian(const Vec3&) const { return {}; }
};

SplineField spline() {
  const FieldGrid grid{Vec3(-2, -2, -1), Vec3::Constant(0.1), {41, 41, 81}};
  RandomStream random(1, 2, 0);
  std::vector<double> values(grid.size());
  for (double& value : values) value = 0.33 + 0.01 * random.uniform();
  return SplineField(grid, values);
}

template <IndexField F>
std::vector<RayState> bundle(const F& field) {
  RandomStream random(1, 1, 0);
  std::vector<RayState> result;
  for (int i = 0; i < rays; ++i) {
    const Vec3 x(radius * (random.uniform() - 0.5), radius * (random.uniform() - 0.5), 0);
    result.push_back(start_ray(field, x, {0.1 * random.uniform(), 0.1 * random.uniform(), 1}));
  }
  return result;
}

double sink = 0;

// One ray after the other: each step waits for the one before.
template <IndexField F>
void one_by_one(const F& field, std::vector<RayState> bundle) {
  for (RayState& ray : bundle) {
    RayState here = ray;
    for (int i = 0; i < steps; ++i) Leapfrog::step(field, here, step);
    ray = here;
  }
  for (const RayState& ray : bundle) sink += ray.optical_path;
}

// A few rays in turn, so that their steps overlap.
template <int Width, IndexField F>
void side_by_side(const F& field, std::vector<RayState> bundle) {
  for (int first = 0; first < rays; first += Width)
    for (int i = 0; i < steps; ++i)
      for (int k = 0; k < Width; ++k) Leapfrog::step(field, bundle[first + k], step);
  for (const RayState& ray : bundle) sink += ray.optical_path;
}

struct Contestant {
  std::string name;
  std::function<void()> run;
  std::vector<double> nanoseconds = {};
};

template <IndexField F>
void enter(std::vector<Contestant>& contest, const std::string& name, const F& field) {
  const auto start = bundle(field);
  contest.push_back({name + ", one ray at a time", [=] { one_by_one(field, start); }});
  contest.push_back({name + ", 4 rays in turn", [=] { side_by_side<4>(field, start); }});
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 31;
  std::vector<Contestant> contest;
  enter(contest, "quartic in rho (floor)", QuarticField{});
  for (const int m : {0, 1, 2, 4})
    enter(contest, "sound, J_" + std::to_string(m),
          StandingWave(0.33, 0.01, m, wavenumber, 4 * radius));
  enter(contest, "J_0 of the C library", LibraryField{});
  enter(contest, "focused sound, 16 waves",
        FocusedSound(0.33, 0.01, wavenumber, arc_directions(16, 0.5), Vec3::UnitZ()));
  enter(contest, "spline grid", spline());
  for (int round = 0; round < rounds; ++round) {
    for (Contestant& entry : contest) {
      const double before = thread_cpu_seconds();
      entry.run();
      entry.nanoseconds.push_back((thread_cpu_seconds() - before) * 1e9 / rays / steps);
    }
  }
  std::printf("%-44s %10s %16s\n", "leapfrog steps, one thread", "ns/step", "million/s");
  for (const Contestant& entry : contest) {
    const double each = bench::median(entry.nanoseconds);
    std::printf("%-44s %10.2f %16.1f\n", entry.name.c_str(), each, 1e3 / each);
  }
  return sink == 0;
}

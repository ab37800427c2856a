// Nanoseconds of one thread for a step of a ray through a ball of 17 nodes: a step of trace's
// (three gradients), one of a search (four), and that with its part of the derivatives by all
// coefficients, of one number or of two. Interleaved; medians. usage: bench_design_speed [rounds]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <vector>

#include "bench/measure/median.h"
#include "core/run/stopwatch.h"
#include "grin/design/adjoint/design_ray.h"
#include "grin/design/adjoint/reading.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/goals/even_points.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;
using namespace flatspeckle::grin::design;

namespace {

constexpr int rays = 400;
const RayWalk walk{0.1, 300};
double sink = 0;

/// Near Luneburg's, so that rays go as a search has them go.
BallSpline lens() {
  const BallForm form{Vec3::Zero(), 1, 17};
  return form.field(std::vector<double>(form.shape().size(), 0.42));
}

DesignRay ray(int i) {
  const Vec3 along = even_direction(i, rays, 0);
  const Vec3 across = 0.9 * (frame_across(along) * even_point(i, rays, 0));
  return {across - std::sqrt(1 - across.squaredNorm()) * along, along, Surface(Sphere())};
}

/// Each returns how many steps it made.
double forward(const BallSpline& field) {
  double steps = 0;
  for (int i = 0; i < rays; ++i) {
    const FollowedRay end = follow<Pefrl>(field, ray(i), walk);
    steps += static_cast<double>(end.steps) + 1;
    sink += end.state.optical_path;
  }
  return steps;
}
template <int K, class Read>
double with_derivatives(const BallSpline& field, const Read& read) {
  double steps = 0;
  CoefficientSums<K> sums(shape_of(field));
  for (int i = 0; i < rays; ++i) {
    const FollowedRay end = follow<Pefrl>(field, ray(i), walk);
    steps += static_cast<double>(end.steps) + 1;
    pull_back<Pefrl>(field, ray(i), walk, end, read(i)(end.state).by, sums);
  }
  sums.take([](std::size_t, const auto& derivatives) { sink += derivatives[0]; });
  return steps;
}
double by_sharma(const BallSpline& field) {
  constexpr int steps = 20;
  for (int i = 0; i < rays; ++i) {
    RayState state = start_ray(field, ray(i).start, ray(i).direction);
    for (int k = 0; k < steps; ++k) Sharma::step(field, state, walk.h);
    sink += state.optical_path;
  }
  return rays * steps;
}

struct Contestant {
  const char* name;
  std::function<double(const BallSpline&)> steps;
  std::vector<double> times = {};
};

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 15;
  const BallSpline field = lens();
  const auto path = [](int) { return PathReading(); };
  const auto screen = [](int i) {
    const Vec3 along = even_direction(i, rays, 0);
    return ScreenReading{along, along, frame_across(along)};
  };
  std::vector<Contestant> contest{
      {"step of trace (Sharma)", by_sharma},
      {"step of a search, to the end", forward},
      {"the same with a gradient", [&](const auto& f) { return with_derivatives<1>(f, path); }},
      {"with those of two numbers", [&](const auto& f) { return with_derivatives<2>(f, screen); }}};
  for (int round = 0; round < rounds; ++round)
    for (Contestant& entry : contest) {
      const double before = process_cpu_seconds();
      double steps = 0;
      for (int again = 0; again < 10; ++again) steps += entry.steps(field);
      entry.times.push_back(1e9 * (process_cpu_seconds() - before) / steps);
    }
  for (const Contestant& entry : contest)
    std::printf("%-30s %6.0f ns\n", entry.name, bench::median(entry.times));
  return sink == 0;
}

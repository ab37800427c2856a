// Connections per second, and where the time goes: random pairs of points in a ball, one thread.
//
//   bench_connections [seconds per row]
//
// A connection is one unbiased estimate: a first trial and, if it found a curve, the further trials
// until that is found again. The time of the three kinds of steps is measured apart, along rays of
// the same field; what is left is the solver itself.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/run/stopwatch.h"
#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/spline_field.h"
#include "grin/media/fields/ultrasound.h"
#include "grin/rays/connections/connection_solver.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;

namespace {

double seconds_per_row = 2;

struct Ball {
  double radius;
  bool operator()(const Vec3& x) const { return x.squaredNorm() <= radius * radius; }
};

Vec3 random_direction(RandomStream& random) {
  return direction_about(Vec3::UnitX(), 2 * random.uniform() - 1,
                         6.283185307179586 * random.uniform());
}
Vec3 random_point(RandomStream& random, double radius) {
  return radius * std::cbrt(random.uniform()) * random_direction(random);
}

/// CPU seconds of one call, over rays from random points that are a ball's radius long.
template <IndexField F, class Step>
double seconds_per_step(const F& field, double radius, double h, Step step) {
  RandomStream random(2, 0, 0);
  const int steps = std::max(1, static_cast<int>(radius / h));
  const double start = thread_cpu_seconds();
  double seen = 0, made = 0;
  do {
    RayState ray = start_ray(field, random_point(random, radius / 2), random_direction(random));
    RayTangent tangent;
    for (int i = 0; i < steps; ++i) step(field, ray, tangent, h);
    seen += ray.x[0] + tangent.dx(0, 0);
    made += steps;
  } while (thread_cpu_seconds() - start < 0.1);
  if (!std::isfinite(seen)) std::printf("# rays were lost\n");
  return (thread_cpu_seconds() - start) / made;
}

template <IndexField F>
void print_row(const std::string& name, const F& field, double radius,
               const ConnectionOptions& options) {
  ConnectionStatistics statistics;
  std::uint64_t pairs = 0;
  const double start = thread_cpu_seconds();
  for (; pairs % 64 || thread_cpu_seconds() - start < seconds_per_row; ++pairs) {
    RandomStream random(1, 0, pairs);
    const Vec3 from = random_point(random, 0.9 * radius), to = random_point(random, 0.9 * radius);
    connect(ConnectionTrial(field, Ball{radius}, from, to, options), random, statistics);
  }
  const double seconds = thread_cpu_seconds() - start;
  const auto guess = [](auto& f, auto& ray, auto&, double h) { Leapfrog::step(f, ray, h); };
  const auto rough = [](auto& f, auto& ray, auto& t, double h) { Leapfrog::step(f, ray, t, h); };
  const auto precise = [](auto& f, auto& ray, auto& t, double h) { Sharma::step(f, ray, t, h); };
  const auto share = [&](std::uint64_t steps, auto step) {
    return 100 * static_cast<double>(steps) * seconds_per_step(field, radius, options.step, step) /
           seconds;
  };
  std::printf("%-22s %9.0f %7.2f %6.1f %6.1f %6.2f %5llu %7.1f %5.0f %5.0f %5.0f\n", name.c_str(),
              static_cast<double>(pairs) / seconds,
              static_cast<double>(statistics.trials()) / static_cast<double>(pairs),
              100 * statistics.success_rate(), statistics.iterations_per_trial(),
              statistics.mean_refind(), static_cast<unsigned long long>(statistics.refind_max),
              static_cast<double>(statistics.guess_steps + statistics.rough_steps +
                                  statistics.tangent_steps) /
                  std::max(1.0, static_cast<double>(statistics.trials())),
              share(statistics.guess_steps, guess), share(statistics.rough_steps, rough),
              share(statistics.tangent_steps, precise));
}

GaussianBlobs blobs(double height) {
  RandomStream random(3, 0, 0);
  std::vector<GaussianBlob> all;
  for (int i = 0; i < 12; ++i)
    all.push_back({random_point(random, 1.2), height * (2 * random.uniform() - 1),
                   0.3 + 0.3 * random.uniform()});
  return GaussianBlobs(all);
}

SplineField spline(double height) {
  RandomStream random(4, 0, 0);
  const FieldGrid grid{Vec3::Constant(-1.5), Vec3::Constant(3.0 / 16), {17, 17, 17}};
  std::vector<double> excess(grid.size());
  for (double& sample : excess) sample = height * (2 * random.uniform() - 1);
  return SplineField(grid, excess);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) seconds_per_row = std::atof(argv[1]);
  std::printf(
      "# trials, K (further trials) per connection; success in %%; steps and Gauss-Newton\n"
      "# iterations per trial; share of time in %% in the steps of guesses, of rough shots\n"
      "# and of precise shots\n");
  std::printf("%-22s %9s %7s %6s %6s %6s %5s %7s %5s %5s %5s\n", "field", "connect/s", "trials",
              "succ", "iter", "K", "Kmax", "steps", "guess", "rough", "prec");
  print_row("homogeneous", Homogeneous{0.33}, 1, {.step = 0.1, .max_length = 4});
  print_row("Luneburg", Luneburg({}), 1, {.step = 0.1, .max_length = 4});
  print_row("fisheye", Fisheye({}), 1, {.step = 0.05, .max_length = 4});
  print_row("parabolic guide", ParabolicGuide({.axis_excess = 0.5, .alpha = 0.6}), 2,
            {.step = 0.1, .max_length = 6});
  print_row("ultrasound J_0 1e-4", StandingWave(0.33, 1e-4, 0, 20, 40), 1,
            {.step = 0.05, .max_length = 4});
  print_row("ultrasound J_0 1e-2", StandingWave(0.33, 1e-2, 0, 20, 40), 1,
            {.step = 0.05, .max_length = 4});
  print_row("12 blobs, +-0.001", blobs(1e-3), 1, {.step = 0.1, .max_length = 4});
  print_row("12 blobs, +-0.3", blobs(0.3), 1, {.step = 0.1, .max_length = 4});
  print_row("spline grid, +-0.001", spline(1e-3), 1, {.step = 0.05, .max_length = 4});
  print_row("spline grid, +-0.1", spline(0.1), 1, {.step = 0.05, .max_length = 4});
}

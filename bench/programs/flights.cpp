// Flights and joins of light transport, one thread: straight space by plan, curved space by field.
//
//   bench_flights [seconds per figure]
//
// Points lie anywhere in the stage, directions everywhere, extinction 2 per length.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/run/stopwatch.h"
#include "grin/render/flights/space.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;

namespace {

double seconds_per_figure = 0.3;
double sink = 0;

Vec3 random_direction(RandomStream& random) {
  return random_turn(Vec3::UnitX(), 2 * random.uniform(), random);
}
/// In the ball of radius 0.95.
PathPoint random_point(RandomStream& random, Part part) {
  return {0.95 * std::cbrt(random.uniform()) * random_direction(random), part};
}

template <class Do>
double nanoseconds(const Do& once) {
  RandomStream random(5, 0, 0);
  long calls = 0;
  const double start = thread_cpu_seconds();
  double now = start;
  while (now - start < seconds_per_figure) {
    for (int i = 0; i < 256; ++i) once(random);
    calls += 256;
    now = thread_cpu_seconds();
  }
  return (now - start) / static_cast<double>(calls) * 1e9;
}

struct Figures {
  double fly, join, found, trials, refind;
};
Figures measure(const Space& space, Part part) {
  // the points' own time is taken off
  const double points = nanoseconds([&](RandomStream& random) {
    sink += random_point(random, part).x[0] + random_direction(random)[0];
  });
  const double fly = nanoseconds([&](RandomStream& random) {
    const PathPoint from = random_point(random, part);
    sink += space.fly(from, random_direction(random), random).spreading;
  });
  ConnectionStatistics statistics;
  double joins = 0, found = 0;
  const double join = nanoseconds([&](RandomStream& random) {
    const PathPoint from = random_point(random, part);
    const auto curve = space.join(from, random_point(random, part), random, statistics);
    ++joins;
    if (curve) {
      ++found;
      sink += curve->spreading;
    }
  });
  return {fly - points, join - points, found / joins,
          static_cast<double>(statistics.trials()) / joins, statistics.success_rate()};
}

void print_straight(const char* name, const Figures& f) {
  std::printf("%-34s %8.1f %8.1f\n", name, f.fly, f.join);
}

void print_curved(const char* name, const AnyIndexField& field, const Stage& stage, double step) {
  const auto quick = make_space(field, stage, {step, 8, Spreading::none});
  const auto full = make_space(field, stage, {step, 8, Spreading::all});
  const Part part = stage.field_part();
  const Figures without = measure(*quick, part), with = measure(*full, part);
  std::printf("%-34s %8.2f %8.2f %8.2f %7.2f %7.2f %7.2f\n", name, without.fly / 1e3,
              with.fly / 1e3, with.join / 1e3, with.found, with.trials, with.refind);
}

GaussianBlobs blobs(double height) {
  RandomStream random(3, 0, 0);
  std::vector<GaussianBlob> all;
  for (int i = 0; i < 12; ++i)
    all.push_back({1.2 * random_point(random, around).x, height * (2 * random.uniform() - 1),
                   0.3 + 0.3 * random.uniform()});
  return GaussianBlobs(all);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) seconds_per_figure = std::atof(argv[1]);
  const ScatteringMedium fog{.mu_s = 2};
  const Stage clear{.boundary = Sphere{}}, foggy{.boundary = Sphere{}, .medium = fog};
  Stage glass = foggy, cloud = foggy, lens{.boundary = Box{{-2, -2, -2}, {2, 2, 2}}};
  glass.bodies.push_back({Sphere{Vec3::Zero(), 0.3}, fog});
  lens.bodies.push_back({Sphere{}, fog});
  const FieldGrid grid{Vec3::Constant(-1), Vec3::Constant(0.1), {21, 21, 21}};
  cloud.medium.density =
      std::make_shared<const DensityGrid>(grid, std::vector<double>(grid.size(), 1));
  std::printf("%-34s %8s %8s\n", "straight, ns", "flight", "join");
  print_straight("nothing in it", measure(Space(Homogeneous{0}, clear), around));
  print_straight("scattering", measure(Space(Homogeneous{0}, foggy), around));
  print_straight(
      "scattering, box",
      measure(Space(Homogeneous{0}, Stage{.boundary = Box{{-1, -1, -1}, {1, 1, 1}}, .medium = fog}),
              around));
  print_straight("grid of density 1", measure(Space(Homogeneous{0}, cloud), around));
  print_straight("glass ball in fog", measure(Space(Homogeneous{0.5}, glass), around));
  std::printf("\n%-34s %8s %8s %8s %7s %7s %7s\n", "curved, us", "flight", "with |J|", "join",
              "found", "trials", "success");
  print_curved("homogeneous", Homogeneous{0.33}, foggy, 0.05);
  print_curved("Luneburg", Luneburg({}), foggy, 0.05);
  print_curved("Luneburg, body in a box", Luneburg({}), lens, 0.05);
  print_curved("fisheye", Fisheye({}), foggy, 0.05);
  print_curved("parabolic guide", ParabolicGuide({.axis_excess = 0.5, .alpha = 0.6}), foggy, 0.05);
  print_curved("ultrasound J_0 1e-4", StandingWave(0.33, 1e-4, 0, 20, 40), foggy, 0.05);
  print_curved("ultrasound J_0 1e-2", StandingWave(0.33, 1e-2, 0, 20, 40), foggy, 0.05);
  print_curved("12 blobs, +-0.001", blobs(1e-3), foggy, 0.05);
  print_curved("12 blobs, +-0.3", blobs(0.3), foggy, 0.05);
  return sink == 1;
}

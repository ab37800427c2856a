// Steps per second and thread, in millions, of each field and integrator: one ray at a time, side
// by side in lanes, in trace() as a user runs it (which also looks for the index mismatch, asking
// the field once more at each step's end) and in flights of light transport. The first rows' field
// costs a few multiplications: the floor of arithmetic; nothing here comes from memory.
// Interleaved; medians. usage: bench_ray_speed [rounds] [part of a field's name]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include <omp.h>

#include "bench/measure/median.h"
#include "core/numbers/random.h"
#include "core/run/stopwatch.h"
#include "grin/rays/marching/ray_lanes.h"
#include "grin/render/flights/space.h"
#include "grin/trace/ray_tracing.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;

namespace {

constexpr int steps = 400, rays = 512;
constexpr double wavenumber = 7, step = 0.005;  // kr rho up to about 14

/// What steps themselves cost.
LinearRamp floor_of_arithmetic() {
  return {0.33, {0.01, 0, 0}};
}

SplineField spline() {
  const FieldGrid grid{Vec3(-2, -2, -1), Vec3::Constant(0.1), {41, 41, 81}};
  RandomStream random(1, 2, 0);
  std::vector<double> values(grid.size());
  for (double& value : values) value = 0.33 + 0.01 * random.uniform();
  return SplineField(grid, values);
}

GaussianBlobs blobs() {
  RandomStream random(3, 0, 0);
  std::vector<GaussianBlob> all;
  for (int i = 0; i < 12; ++i)
    all.push_back({{random.uniform(), random.uniform(), 2 * random.uniform()},
                   0.02 * random.uniform(),
                   0.3 + 0.3 * random.uniform()});
  return GaussianBlobs(all, 0.33);
}

std::vector<RayStart> starts(int count) {
  RandomStream random(1, 1, 0);
  std::vector<RayStart> result;
  for (int i = 0; i < count; ++i) {
    const Vec3 x(random.uniform() - 0.5, random.uniform() - 0.5, 0);
    result.push_back({x, Vec3(0.1 * random.uniform(), 0.1 * random.uniform(), 1).normalized()});
  }
  return result;
}

double sink = 0;

struct Contestant {
  std::function<double()> steps;  ///< that it makes
  std::vector<double> speeds = {};
};

template <IndexField F>
std::vector<RayState> bundle(const F& field) {
  std::vector<RayState> result;
  for (const RayStart& start : starts(lanes))
    result.push_back(start_ray(field, start.x, start.direction));
  return result;
}

template <class Integrator, IndexField F>
double one_by_one(const F& field) {
  for (RayState ray : bundle(field)) {
    for (int i = 0; i < steps; ++i) Integrator::step(field, ray, step);
    sink += ray.optical_path;
  }
  return lanes * steps;
}

template <class Integrator, LaneField F>
double side_by_side(const F& field) {
  RayLanes all{};
  const auto from = bundle(field);
  for (int lane = 0; lane < lanes; ++lane) all.put(lane, from[static_cast<std::size_t>(lane)]);
  std::fill_n(all.step, lanes, step);
  make_steps(Integrator(), field, all, 4 * steps);
  for (int lane = 0; lane < lanes; ++lane) sink += all.optical_path[lane];
  return 4 * lanes * steps;
}

template <class Integrator, IndexField F>
double traced(const F& field, const std::vector<RayStart>& from) {
  const SceneField scene{facts(field), field};
  const RayStops stops{{Plane{{0, 0, 2}, Vec3::UnitZ()}}, 10, 1e-10};
  double made = 0;
  for (const TracedRay& ray : trace_rays(scene, {}, stops, {Integrator(), step}, from, 0)) {
    made += static_cast<double>(ray.steps);
    sink += ray.end.optical_path;
  }
  return made;
}

/// Rays of the same light through a box, as unscattered light goes.
double flown(const Space& space, const std::vector<RayStart>& from) {
  RandomStream random(1, 2, 0);
  double arc = 0;
  std::size_t next = 0;
  const auto count = [&](const Flight& flight) { arc += flight.optical_path; };
  const auto start = [&]() -> std::optional<Space::FlightStart> {
    if (next == from.size()) return std::nullopt;
    const RayStart& one = from[next++];
    return Space::FlightStart{{one.x}, one.direction, &random};
  };
  if (space.has_lanes()) {
    space.fly_side_by_side([&](int, const Flight* flight) {
      if (flight) count(*flight);
      return start();
    });
  } else {
    while (const auto one = start()) count(space.fly(one->from, one->direction, random));
  }
  sink += arc;
  return arc / (1.33 * 1.33 * step);  // dsigma = ds / n
}

struct Row {
  std::string field, integrator;
  std::vector<Contestant> contest;
};

template <class Integrator, IndexField F>
Row row(const std::string& name, const F& field) {
  const auto from = std::make_shared<const std::vector<RayStart>>(starts(rays));
  Row found{name, Integrator::word, {}};
  found.contest.push_back({[=] { return one_by_one<Integrator>(field); }});
  found.contest.push_back({});
  if constexpr (LaneField<F>)
    found.contest.back().steps = [=] { return side_by_side<Integrator>(field); };
  found.contest.push_back({[=] { return traced<Integrator>(field, *from); }});
  const bool leaps = std::same_as<Integrator, Leapfrog>;
  if (leaps ? goes_by_leapfrog<F> : std::same_as<Integrator, Sharma>) {
    const Stage box{.boundary = Box{{-3, -3, -1e-3}, {3, 3, 2}}};
    const std::shared_ptr<const Space> space =
        make_space(field, box, {step, 100, Spreading::none, leaps});
    found.contest.push_back({[=] { return flown(*space, *from); }});
  }
  return found;
}

template <IndexField F>
void enter(std::vector<Row>& rows, const std::string& name, const F& field) {
  rows.push_back(row<Leapfrog>(name, field));
  rows.push_back(row<Yoshida4>(name, field));
  rows.push_back(row<Sharma>(name, field));
}

}  // namespace

int main(int argc, char** argv) {
  omp_set_num_threads(1);  // one that waits would cost as much as one that works
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 9;
  std::vector<Row> rows;
  enter(rows, "linear (floor)", floor_of_arithmetic());
  for (const int m : {0, 1, 4})
    enter(rows, "sound, J_" + std::to_string(m), StandingWave(0.33, 0.01, m, wavenumber, 4));
  enter(rows, "focused sound, 16 waves",
        FocusedSound(0.33, 0.01, wavenumber, arc_directions(16, 0.5), Vec3::UnitZ()));
  enter(rows, "12 blobs", blobs());
  enter(rows, "parabolic", ParabolicGuide({0.33, 0.3}));
  enter(rows, "fisheye", Fisheye({0.33, 5}));
  enter(rows, "tanh", TanhRamp{0.33, 0.4, 0.5});
  enter(rows, "sech", SechGuide({0.33, 0.3}));
  enter(rows, "spline grid", spline());
  const std::string part = argc > 2 ? argv[2] : "";
  std::erase_if(rows, [&](const Row& row) { return row.field.find(part) == std::string::npos; });
  for (int round = 0; round < rounds; ++round)
    for (Row& row : rows)
      for (Contestant& entry : row.contest) {
        if (!entry.steps) continue;
        const double before = process_cpu_seconds();
        const double made = entry.steps();
        entry.speeds.push_back(made / (process_cpu_seconds() - before) / 1e6);
      }
  std::printf("million steps a second        one by one  in lanes     trace   flights\n");
  for (Row& row : rows) {
    std::printf("%-26s %-9s", row.field.c_str(), row.integrator.c_str());
    for (Contestant& entry : row.contest)
      if (entry.speeds.empty())
        std::printf(" %9s", "-");
      else
        std::printf(" %9.1f", bench::median(entry.speeds));
    std::puts("");
  }
  return sink == 0;
}

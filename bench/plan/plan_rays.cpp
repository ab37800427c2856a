#include <algorithm>
#include <cmath>
#include <variant>

#include "bench/plan/plan_rooms.h"
#include "bench/plan/plan_timing.h"
#include "grin/rays/marching/trace.h"
#include "grin/render/flights/space.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;

constexpr int rays = 200;
constexpr double step = 0.05, max_length = 8;

Vec3 random_direction(RandomStream& random) {
  return random_turn(Vec3::UnitX(), 2 * random.uniform(), random);
}
/// In the ball of radius 0.95.
PathPoint random_point(RandomStream& random) {
  return {0.95 * std::cbrt(random.uniform()) * random_direction(random)};
}

/// Appends what is known of a point on a way.
void note(std::vector<Complex>& values, const Vec3& x, double optical_path) {
  values.insert(values.end(), {{x[0], x[1]}, {x[2], optical_path}});
}

/// Rays from anywhere in the unit ball to its surface.
template <IndexField F>
std::vector<Complex> traced(const F& field) {
  const Surface ball = Sphere{};
  std::vector<Complex> values;
  RandomStream random(1, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const Vec3 from = random_point(random).x;
    RayState ray = start_ray(field, from, random_direction(random));
    FixedSteps<Sharma> steps{step};
    trace(field, {&ball, 1}, {max_length, 1e-13}, steps, ray);
    note(values, ray.x, ray.optical_path);
  }
  return values;
}

/// Flights from anywhere in the unit ball, with the same random numbers in every call.
std::vector<Complex> flown(const Space& space) {
  std::vector<Complex> values;
  RandomStream random(1, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const PathPoint from = random_point(random);
    const Flight flight = space.fly(from, random_direction(random), random);
    note(values, flight.point.x, flight.optical_path);
  }
  return values;
}

/// Joins of pairs of points, the same in every space: per batch, sums of what the curves have, each
/// weighted so that those not found count (C26).
SampledKernel joins(const Space& space) {
  constexpr int pairs = 50;
  return {2, pairs,
          [&space](std::uint64_t number, std::span<Complex> sums) {
            ConnectionStatistics statistics;
            RandomStream points(1, 0, number), random(1, 1, number);
            for (int i = 0; i < pairs; ++i) {
              const PathPoint from = random_point(points), to = random_point(points);
              const auto join = space.join(from, to, random, statistics);
              if (!join) continue;
              sums[0] += join->multiplicity;
              sums[1] += join->multiplicity * Complex(join->spreading, join->optical_path);
            }
          },
          sample_mean};
}

/// A field whose kind is looked up at every step.
struct LookedUpField {
  AnyIndexField field;

  double excess(const Vec3& x) const {
    return std::visit([&](const auto& f) { return f.excess(x); }, field);
  }
  IndexGradient gradient(const Vec3& x) const {
    return std::visit([&](const auto& f) { return f.gradient(x); }, field);
  }
  IndexHessian hessian(const Vec3& x) const {
    return std::visit([&](const auto& f) { return f.hessian(x); }, field);
  }
};

Stage foggy_ball_stage() {
  return {.boundary = Sphere{}, .medium = {.mu_s = 2}};
}

/// An index that is the same everywhere, which the compiler does not know.
ParabolicGuide constant_guide() {
  return ParabolicGuide({0.5, 0});
}

template <class General, class Special>
PlanRow same_values(const General& general, const Special& special, const char* per, double limit,
                    double cpu_seconds) {
  PlanRow row{.per = per};
  compare_values(row, general, special, limit, cpu_seconds);
  row.general_s /= rays;
  row.special_s /= rays;
  return row;
}

PlanRow curved_rays(double cpu_seconds) {
  return same_values([] { return traced(constant_guide()); },
                     [] { return traced(Homogeneous{0.5}); }, "ray", 1e-11, cpu_seconds);
}

PlanRow kind_of_field(double cpu_seconds) {
  const Luneburg field({});
  const LookedUpField looked_up{field};
  return same_values([&] { return traced(looked_up); }, [&] { return traced(field); }, "ray", 1e-14,
                     cpu_seconds);
}

PlanRow spreading(double cpu_seconds) {
  const Fisheye field({1, 1.5});
  const auto full = make_space(field, foggy_ball_stage(), {step, max_length, Spreading::all});
  const auto quick = make_space(field, foggy_ball_stage(), {step, max_length, Spreading::none});
  return same_values([&] { return flown(*full); }, [&] { return flown(*quick); }, "flight", 1e-11,
                     cpu_seconds);
}

/// Rays from anywhere in a ball out of it.
std::vector<Complex> flown_out(const RayField& field, const Sphere& ball, double h) {
  const Surface surface = ball;
  const PartMedium clear;
  std::vector<Complex> values;
  RandomStream random(1, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const Vec3 from = ball.radius * random_point(random).x;
    RayState ray = start_ray(field, from, random_direction(random));
    double weight = 1;
    field.fly({{{&surface, 1}}, clear, h}, 10 * ball.radius, weight, random, ray, nullptr);
    note(values, ray.x, ray.optical_path);
  }
  return values;
}

PlanRow closed_forms(double cpu_seconds) {
  const Sphere ball;
  const Surface rim = ball;
  const auto by_steps = make_ray_field(Luneburg({1, LuneburgProfile::for_stops}));
  const auto closed = make_ray_field(Luneburg({}), {&rim, 1});
  return same_values([&] { return flown_out(*by_steps, ball, step); },
                     [&] { return flown_out(*closed, ball, step); }, "ray", 1e-6, cpu_seconds);
}

/// Both to steps that render would choose.
PlanRow leapfrogs(double cpu_seconds) {
  const StandingWave field(0.33, 1e-3, 0, 3.4, 20);
  const auto by_sharma = make_ray_field(field), by_leaps = make_ray_field(field, {}, true);
  const Sphere ball{Vec3::Zero(), 15};
  return same_values([&] { return flown_out(*by_sharma, ball, 0.88); },
                     [&] { return flown_out(*by_leaps, ball, 0.7); }, "ray", 2e-4, cpu_seconds);
}

/// So many steps of a bundle, far from everything.
template <class Go>
std::vector<Complex> went_on(const RayField& field, const Go& go) {
  RayLanes bundle{};
  std::fill_n(bundle.step, lanes, step);
  RandomStream random(1, 0, 0);
  for (int lane = 0; lane < lanes; ++lane)
    bundle.put(lane, start_ray(field, random_point(random).x, random_direction(random)));
  go(bundle);
  std::vector<Complex> values;
  for (int lane = 0; lane < lanes; ++lane)
    note(values, bundle.at(lane).x, bundle.at(lane).optical_path);
  return values;
}

PlanRow one_ray_at_a_time(double cpu_seconds) {
  constexpr int steps = 200;
  const auto field = make_ray_field(StandingWave(0.33, 1e-3, 0, 3.4, 20), {}, true);
  const auto one_by_one = [&](RayLanes& bundle) {
    for (int lane = 0; lane < lanes; ++lane) {
      RayState ray = bundle.at(lane);
      field->advance(steps * step, steps, ray, nullptr);
      bundle.put(lane, ray);
    }
  };
  const auto in_lanes = [&](RayLanes& bundle) { field->advance_lanes(steps, bundle); };
  PlanRow row{.per = "ray"};
  compare_values(
      row, [&] { return went_on(*field, one_by_one); }, [&] { return went_on(*field, in_lanes); },
      1e-12, cpu_seconds);
  row.general_s /= lanes;
  row.special_s /= lanes;
  return row;
}

PlanRow search_for_curves(double cpu_seconds) {
  PlanRow row{.per = "join"};
  const auto general =
      make_space(constant_guide(), foggy_ball_stage(), {step, max_length, Spreading::all});
  const Space special(Homogeneous{0.5}, foggy_ball_stage());
  compare_sampled(row, joins(*general), joins(special), Numbers::other, Measure::sample,
                  cpu_seconds);
  return row;
}

}  // namespace

std::vector<PlanCase> ray_plan_cases() {
  const auto row = [](const std::string& left_out, const std::string& scene, const auto& run) {
    return named("grin rays", left_out, scene, run);
  };
  return {row("curvature", "constant index, rays out of a ball", curved_rays),
          row("search for curves", "constant index, joins in a ball", search_for_curves),
          row("|J| of flights", "fisheye", spreading),
          row("steps", "Luneburg ball, rays in closed form", closed_forms),
          row("two forces of three a step", "weak sound, by leapfrog", leapfrogs),
          row("waiting for a ray's last step", "sound, rays side by side", one_ray_at_a_time),
          row("kind of field at every step", "Luneburg ball", kind_of_field)};
}

}  // namespace flatspeckle::bench

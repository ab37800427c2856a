#include <algorithm>
#include <cmath>
#include <memory>
#include <variant>

#include "bench/plan/plan_timing.h"
#include "grin/rays/marching/trace.h"
#include "grin/render/flights/space.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;

constexpr int rays = 200;
constexpr double step = 0.05, max_length = 8;

Vec3 turned(RandomStream& random) {
  return random_turn(Vec3::UnitX(), 2 * random.uniform(), random);
}
/// Samples a point in the ball of radius 0.95.
PathPoint place(RandomStream& random) {
  return {0.95 * std::cbrt(random.uniform()) * turned(random)};
}

/// Appends the position of a point on a ray and its optical path.
void note(std::vector<Complex>& values, const Vec3& x, double optical_path) {
  values.insert(values.end(), {{x[0], x[1]}, {x[2], optical_path}});
}

/// Traces rays from random points in the unit ball to its surface.
template <grin::IndexField F>
std::vector<Complex> traced(const F& field) {
  const Surface ball = Sphere{};
  std::vector<Complex> values;
  RandomStream random(1, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const Vec3 from = place(random).x;
    RayState ray = start_ray(field, from, turned(random));
    FixedSteps<Sharma> steps{step};
    trace(field, {&ball, 1}, {max_length, 1e-13}, steps, ray);
    note(values, ray.x, ray.optical_path);
  }
  return values;
}

/// Samples free flights from random points in the unit ball. Every call uses the same random
/// numbers.
std::vector<Complex> flown(const Space& space) {
  std::vector<Complex> values;
  RandomStream random(1, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const PathPoint from = place(random);
    const Flight flight = space.fly(from, turned(random), random);
    note(values, flight.point.x, flight.optical_path);
  }
  return values;
}

/// Makes a kernel that connects pairs of points by curves; the pairs are the same for every space.
/// Each batch sums properties of the curves found, weighted so that the expectation is the sum over
/// all curves (C26).
SampledKernel connections(const std::shared_ptr<const Space>& space) {
  constexpr int pairs = 50;
  return {2, pairs,
          [=](std::uint64_t number, std::span<Complex> sums) {
            ConnectionStatistics statistics;
            RandomStream points(1, 0, number), random(1, 1, number);
            for (int i = 0; i < pairs; ++i) {
              const PathPoint from = place(points), to = place(points);
              const auto connection = space->connect(from, to, random, statistics);
              if (!connection) continue;
              sums[0] += connection->multiplicity;
              sums[1] += connection->multiplicity *
                         Complex(connection->spreading, connection->optical_path);
            }
          },
          sample_mean};
}

/// A field whose type is dispatched at every step.
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

/// Returns a guide with a constant index, which the compiler cannot treat as constant.
ParabolicGuide constant_guide() {
  return ParabolicGuide({0.5, 0});
}

TwoAlternatives curved_rays(bool) {
  return {[] { return traced(constant_guide()); }, [] { return traced(Homogeneous{0.5}); }};
}

TwoAlternatives kind_of_field(bool) {
  return {[looked_up = LookedUpField{Luneburg({})}] { return traced(looked_up); },
          [field = Luneburg({})] { return traced(field); }};
}

TwoAlternatives spreading(bool) {
  const auto flights = [](Spreading spreading) {
    const std::shared_ptr<const Space> space =
        make_space(Fisheye({1, 1.5}), foggy_ball_stage(), {step, max_length, spreading});
    return [=] { return flown(*space); };
  };
  return {flights(Spreading::all), flights(Spreading::none)};
}

/// Traces rays from random points in a ball to its surface.
std::vector<Complex> flown_out(const RayField& field, const Sphere& ball, double h) {
  const Surface surface = ball;
  const PartMedium clear;
  std::vector<Complex> values;
  RandomStream random(1, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const Vec3 from = ball.radius * place(random).x;
    RayState ray = start_ray(field, from, turned(random));
    double weight = 1;
    field.fly({{{&surface, 1}}, clear, h}, 10 * ball.radius, weight, random, ray, nullptr);
    note(values, ray.x, ray.optical_path);
  }
  return values;
}

ValueFunction rays_out(const std::shared_ptr<const RayField>& field, const Sphere& ball, double h) {
  return [=] { return flown_out(*field, ball, h); };
}

TwoAlternatives closed_forms(bool) {
  const Sphere ball;
  const Surface rim = ball;
  return {rays_out(make_ray_field(Luneburg({1, LuneburgProfile::for_stops})), ball, step),
          rays_out(make_ray_field(Luneburg({}), {&rim, 1}), ball, step)};
}

/// Compares the integrators at the step sizes that render would choose.
TwoAlternatives leapfrogs(bool) {
  const StandingWave field(0.33, 1e-3, 0, 3.4, 20);
  const Sphere ball{Vec3::Zero(), 15};
  return {rays_out(make_ray_field(field), ball, 0.88),
          rays_out(make_ray_field(field, {}, true), ball, 0.7)};
}

/// Advances a bundle of rays that are far from all surfaces.
template <class Go>
std::vector<Complex> advanced(const RayField& field, const Go& go) {
  RayLanes bundle{};
  std::fill_n(bundle.step, lanes, step);
  RandomStream random(1, 0, 0);
  for (int lane = 0; lane < lanes; ++lane)
    bundle.put(lane, start_ray(field, place(random).x, turned(random)));
  go(bundle);
  std::vector<Complex> values;
  for (int lane = 0; lane < lanes; ++lane)
    note(values, bundle.at(lane).x, bundle.at(lane).optical_path);
  return values;
}

TwoAlternatives one_ray_at_a_time(bool) {
  constexpr int steps = 200;
  const std::shared_ptr<const RayField> field =
      make_ray_field(StandingWave(0.33, 1e-3, 0, 3.4, 20), {}, true);
  const auto one_by_one = [=](RayLanes& bundle) {
    for (int lane = 0; lane < lanes; ++lane) {
      RayState ray = bundle.at(lane);
      field->advance(steps * step, steps, ray, nullptr);
      bundle.put(lane, ray);
    }
  };
  const auto in_lanes = [=](RayLanes& bundle) { field->advance_lanes(steps, bundle); };
  return {[=] { return advanced(*field, one_by_one); }, [=] { return advanced(*field, in_lanes); }};
}

TwoKernels search_for_curves() {
  return {connections(make_space(constant_guide(), foggy_ball_stage(), {step, max_length})),
          connections(make_space(Homogeneous{0.5}, foggy_ball_stage()))};
}

}  // namespace

std::vector<PlanCase> ray_plan_cases() {
  const auto row = [](const std::string& left_out, const std::string& scene, const std::string& per,
                      double limit, TwoAlternatives (*make)(bool), int count = rays) {
    return case_of_values({"grin rays", left_out, scene, per}, limit, make, count);
  };
  return {row("curvature", "constant index, rays out of a ball", "ray", 1e-11, curved_rays),
          case_of_samples({"grin rays", "search for curves",
                           "constant index, connections in a ball", "connection"},
                          Draws::other, Measure::sample, search_for_curves),
          row("|J| of flights", "fisheye", "flight", 1e-11, spreading),
          row("steps", "Luneburg ball, rays in closed form", "ray", 1e-6, closed_forms),
          row("two forces of three a step", "weak sound, by leapfrog", "ray", 2e-4, leapfrogs),
          row("waiting for a ray's last step", "sound, rays side by side", "ray", 1e-12,
              one_ray_at_a_time, lanes),
          row("kind of field at every step", "Luneburg ball", "ray", 1e-14, kind_of_field)};
}

}  // namespace flatspeckle::bench

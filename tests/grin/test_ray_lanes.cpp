#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "core/numbers/wide/functions.h"
#include "grin/media/fields/any_index_field.h"
#include "grin/rays/marching/ray_lanes.h"
#include "grin/trace/trace_scene.h"

// Rays in SIMD lanes, against the same rays one by one.

namespace flatspeckle::grin::test_ray_lanes {

namespace {

using std::numbers::pi;
constexpr double step = 0.01;

Vec3 random_point(RandomStream& random, double size) {
  return size * Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
}

GaussianBlobs blobs() {
  RandomStream random(3, 0, 0);
  std::vector<GaussianBlob> all;
  for (int i = 0; i < 5; ++i)
    all.push_back({random_point(random, 1), 0.2 * random.uniform() - 0.1, 0.3 + random.uniform()});
  return GaussianBlobs(all, 0.2);
}

Transducers transducers() {
  return {0.33,
          {{0.01, 7, 0.3, {0.1, 0, 0.2}, {1, 0, 2}, 0.4}, {-0.02, 5, 1, {0, 0, 0}, {0, 1, 0}, 0}},
          8};
}

SplineField grid() {
  const FieldGrid where{Vec3(-0.4, -0.5, -0.45), Vec3(0.3, 0.25, 0.35), {4, 5, 4}};
  RandomStream random(4, 0, 0);
  std::vector<double> values(where.size());
  for (double& value : values) value = 0.3 + 0.02 * random.uniform();
  return SplineField(where, values);
}

/// Calls check(name, field) for each kind of field that has lanes.
template <class Check>
void for_each_field(const Check& check) {
  check("J_0", StandingWave(0.33, 0.02, 0, 7, 4));
  check("J_1", StandingWave(0.33, 0.02, 1, 7, 4));
  check("J_6", StandingWave(0.33, 0.02, 6, 7, 4));
  check("focused sound", FocusedSound(0.33, 0.02, 7, cap_directions(8, 0.5), {0.1, 0, 0.2}, 0.4));
  check("transducers", transducers());
  check("blobs", blobs());
  check("parabolic", ParabolicGuide({0.5, 0.6}, {0.1, 0.2, 0}));
  check("fisheye", Fisheye({}, {0.1, 0.2, 0.3}));
  check("Luneburg", Luneburg({1, 0.4}));
  check("sech", SechGuide({0.5, 0.6}, {0.1, 0.2, 0}));
  check("grid", grid());
  check("sum", AnySum()
                   .add(SechGuide({0.2, 0.6}))
                   .add(StandingWave(0, 0.02, 1, 7, 4))
                   .add(RadialSpline({2, {0.1, 0.2, 0.15, 0.1, 0.05}}))
                   .add(blobs())
                   .add(blobs()));
  check("linear", LinearRamp{0.3, {0.1, -0.05, 0.2}});
  check("tanh", TanhRamp{0.1, 0.4, 0.3, Vec3(1, 2, 2) / 3, {0.1, 0, 0}});
}

template <LaneField F>
std::vector<RayState> bundle(const F& field) {
  RandomStream random(5, 0, 0);
  std::vector<RayState> rays;
  for (int i = 0; i < lanes; ++i)
    rays.push_back(start_ray(field, random_point(random, 1), random_point(random, 1)));
  return rays;
}

RayLanes in_lanes(const std::vector<RayState>& rays) {
  RayLanes all{};
  for (int lane = 0; lane < lanes; ++lane) all.put(lane, rays[static_cast<std::size_t>(lane)]);
  std::fill_n(all.step, lanes, step);
  return all;
}

double apart(const RayState& a, const RayState& b) {
  return std::max({(a.x - b.x).norm(), (a.v - b.v).norm(), std::abs(a.arc_length - b.arc_length),
                   std::abs(a.optical_path - b.optical_path)});
}

bool same_bits(const RayState& a, const RayState& b) {
  return a.x == b.x && a.v == b.v && a.arc_length == b.arc_length &&
         a.optical_path == b.optical_path;
}

template <class Integrator, LaneField F>
void check_steps(Integrator by, const F& field) {
  constexpr int steps = 50;
  std::vector<RayState> rays = bundle(field);
  RayLanes all = in_lanes(rays);
  make_steps(by, field, all, steps);
  check_for_mismatch(field, all);
  double worst = 0, mismatch_apart = 0;
  for (int lane = 0; lane < lanes; ++lane) {
    RayState ray = rays[static_cast<std::size_t>(lane)];
    for (int i = 0; i < steps; ++i) Integrator::step(field, ray, step);
    const double mismatch = std::abs(ray.v.norm() - index(field, ray.x));
    worst = std::max(worst, apart(all.at(lane), ray));
    mismatch_apart = std::max(mismatch_apart, std::abs(all.index_mismatch[lane] - mismatch));
  }
  CAPTURE(Integrator::word);
  CHECK(worst < 2e-14);
  CHECK(mismatch_apart < 2e-14);
}

}  // namespace

TEST_CASE("branch-free functions: agree with the standard library") {
  RandomStream random(1, 0, 0);
  double off_exp = 0, off_sine = 0, off_cosine = 0;
  for (int i = 0; i < 100'000; ++i) {
    const double x = 1400 * random.uniform() - 700,
                 y = (i % 2 ? 10 : 1e5) * (random.uniform() - 0.5);
    const long double e = std::exp(static_cast<long double>(x));
    off_exp = std::max(off_exp, static_cast<double>(std::abs((wide_exp(x) - e) / e)));
    const auto [sine, cosine] = wide_sine_cosine(y);
    const long double z = y;
    off_sine = std::max(off_sine, static_cast<double>(std::abs(sine - std::sin(z))));
    off_cosine = std::max(off_cosine, static_cast<double>(std::abs(cosine - std::cos(z))));
  }
  CHECK(off_exp < 2.5e-16);
  CHECK(off_sine < 2.5e-16);
  CHECK(off_cosine < 2.5e-16);
  CHECK(wide_exp(-1e300) < 1e-300);
  CHECK(std::isnan(wide_exp(std::nan(""))));
}

TEST_CASE("gradients in lanes: agree with single points") {
  for_each_field([](const char* name, const auto& field) {
    CAPTURE(std::string(name));
    const std::vector<RayState> rays = bundle(field);
    LaneGradients found;
    field.gradients(in_lanes(rays).x, found);
    for (int lane = 0; lane < lanes; ++lane) {
      const IndexGradient at = field.gradient(rays[static_cast<std::size_t>(lane)].x);
      CHECK(std::abs(found.excess[lane] - at.excess) < 2e-15);
      CHECK((found.gradient.at(lane) - at.gradient).norm() < 2e-14 * (1 + at.gradient.norm()));
    }
  });
}

TEST_CASE("sound in lanes: NaN beyond its table") {
  const StandingWave field(0.33, 0.02, 0, 7, 0.3);
  const std::vector<RayState> rays = bundle(field);
  LaneGradients found;
  field.gradients(in_lanes(rays).x, found);
  int beyond = 0;
  for (int lane = 0; lane < lanes; ++lane) {
    const Vec3& x = rays[static_cast<std::size_t>(lane)].x;
    const double rho = std::hypot(x[0], x[1]);
    if (std::abs(rho - 0.3) < 0.125 / 7) continue;  // the last cell of the table is complete
    CHECK(std::isnan(found.excess[lane]) == (rho > 0.3));
    CHECK(std::isnan(found.gradient.x[lane]) == (rho > 0.3));
    beyond += rho > 0.3;
  }
  CHECK(beyond > 2);
  CHECK(beyond < lanes - 2);
}

TEST_CASE("steps in lanes: agree with single rays") {
  for_each_field([](const char* name, const auto& field) {
    CAPTURE(std::string(name));
    check_steps(Leapfrog(), field);
    check_steps(Yoshida4(), field);
    check_steps(Sharma(), field);
  });
}

TEST_CASE("steps in lanes: independent of the lane and of other rays, bit for bit") {
  for_each_field([](const char* name, const auto& field) {
    CAPTURE(std::string(name));
    std::vector<RayState> rays = bundle(field), turned = rays;
    std::rotate(turned.begin(), turned.begin() + 5, turned.end());
    RayLanes all = in_lanes(rays), again = in_lanes(turned), alone = in_lanes(rays);
    for (int lane = 1; lane < lanes; ++lane) alone.put(lane, rays[0]);
    make_steps(Sharma(), field, all, 20);
    make_steps(Sharma(), field, again, 20);
    make_steps(Sharma(), field, alone, 20);
    for (int lane = 0; lane < lanes; ++lane) {
      CHECK(same_bits(all.at((lane + 5) % lanes), again.at(lane)));
      CHECK(same_bits(alone.at(lane), all.at(0)));
    }
  });
}

namespace {

/// Returns rays that end on a sphere, on a plane and at their full length.
TraceValues rays_through_sound(const char* integrator) {
  TraceValues values;
  values.field.field = {"ultrasound"};
  auto& sound = values.field.of<UltrasoundValues>();
  sound.index = 1.33;
  sound.amplitude = 0.01;
  sound.sound_wavenumber = 7;
  values.starts.light = "cone";
  values.starts.half_angle = 0.5;
  values.starts.ray_count = 100;
  values.stops.stop_plane = {0, 0, 3, 0, 0, 1};
  values.stops.stop_sphere = {0.5, 0, 1.5, 0.3};
  values.stops.max_length = 3.1;
  values.stops.step = 0.01;
  values.stops.integrator = integrator;
  return values;
}

/// Returns rays of which most leave the table of the wave, which ends at k rho = 1000.
TraceValues rays_past_the_table() {
  TraceValues values = rays_through_sound("leapfrog");
  auto& sound = values.field.of<UltrasoundValues>();
  sound.amplitude = 1e-8;
  sound.sound_wavenumber = 2000;
  return values;
}

TraceValues rays_through_lens() {
  TraceValues values;
  values.field.field = {"luneburg"};
  values.starts.light = "disk";
  values.starts.beam_radius = 0.9;
  values.starts.origin = {0, 0, -2};
  values.starts.ray_count = 70;
  values.stops.stop_plane = {0, 0, 2, 0, 0, 1};
  values.stops.max_length = 10;
  values.stops.step = 0.01;
  return values;
}

/// Compares with rays that are traced one by one, because their paths are kept.
void check_same_rays(TraceValues values, double limit) {
  const auto together = trace_rays(make_trace_scene(values));
  values.path_points = 2;
  const auto alone = trace_rays(make_trace_scene(values));
  REQUIRE(together.size() == alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    CAPTURE(i);
    CHECK(together[i].status == alone[i].status);
    CHECK(together[i].surface == alone[i].surface);
    CHECK(together[i].steps == alone[i].steps);
    CHECK(apart(together[i].end, alone[i].end) < limit);
    CHECK(std::abs(together[i].index_mismatch - alone[i].index_mismatch) < limit);
  }
}

}  // namespace

TEST_CASE("traces in lanes: ends and statistics agree with single rays") {
  for (const char* integrator : {"leapfrog", "yoshida4", "sharma"})
    check_same_rays(rays_through_sound(integrator), 1e-12);
  check_same_rays(rays_past_the_table(), 1e-12);
  check_same_rays(rays_through_lens(), 1e-9);  // the rim is located to 1e-10
}

TEST_CASE("one transducer: agrees with focused sound") {
  const Transducers one(0.33, {{0.02, 7, 0.4, {0.1, 0, 0.2}, Vec3::UnitZ(), 0.5}}, 8);
  const FocusedSound same(0.33, 0.02, 7, cap_directions(8, 0.5), {0.1, 0, 0.2}, 0.4);
  // on the axis only, as the spiral of directions may be rotated about it
  for (const double z : {-0.3, 0.0, 0.2, 1.0}) {
    const Vec3 x(0.1, 0, z);
    CHECK(std::abs(one.excess(x) - same.excess(x)) < 1e-15);
    CHECK(std::abs(one.gradient(x).gradient[2] - same.gradient(x).gradient[2]) < 1e-14);
  }
}

TEST_CASE("transducers: derivatives agree with differences") {
  const Transducers field = transducers();
  const Vec3 x(0.2, -0.1, 0.4);
  const IndexHessian at = field.hessian(x);
  constexpr double h = 1e-5;
  for (int i = 0; i < 3; ++i) {
    const Vec3 d = h * Vec3::Unit(i);
    const double derivative = (field.excess(x + d) - field.excess(x - d)) / (2 * h);
    CHECK(std::abs(derivative - at.gradient[i]) < 1e-9);
    const Vec3 bend = (field.gradient(x + d).gradient - field.gradient(x - d).gradient) / (2 * h);
    CHECK((bend - at.hessian.col(i)).norm() < 1e-8);
  }
}

/// The mean over phases of two plane waves is the background. The mean of their product is 0 if
/// their frequencies differ, but not if they are equal.
TEST_CASE("transducers: means over phases agree with independent frequencies") {
  const auto product_at_origin = [](double second) {
    const Vec3 origin = Vec3::Zero(), along = Vec3::UnitX();
    const Transducers both(0, {{1, 7, 0, origin, along, 0}, {1, second, 0, origin, along, 0}}, 1);
    constexpr int phases = 4001;
    double mean = 0, square = 0;
    for (int i = 0; i < phases; ++i) {
      const double n = both.frozen(2 * pi * (i + 0.5) / phases).excess(Vec3::Zero());
      mean += n / phases;
      square += n * n / phases;
    }
    CHECK(std::abs(mean) < 0.05);
    return square;
  };
  CHECK(product_at_origin(7) == doctest::Approx(2).epsilon(1e-6));
  CHECK(product_at_origin(6.18034) == doctest::Approx(1).epsilon(0.05));
  const Transducers one(0.1, {{1, 7, 0.2, Vec3::Zero(), Vec3::UnitX(), 0}}, 1);
  CHECK(one.frozen(0.7).excess(Vec3::Zero()) ==
        doctest::Approx(0.1 + std::cos(0.9)).epsilon(1e-12));
}

}  // namespace flatspeckle::grin::test_ray_lanes

#include <filesystem>
#include <fstream>
#include <numbers>
#include <unistd.h>

#include <doctest/doctest.h>

#include "grin/render/values/render_values.h"
#include "grin/trace/trace_scene.h"

// Scenes from plain structs, without a command line: their contents, and errors that name keys.

namespace flatspeckle::grin::test_scene_values {

namespace {

using std::numbers::pi;

/// Returns the message with which make() is rejected, "" if it is not.
template <class Make>
std::string refusal(const Make& make) {
  try {
    make();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

template <class Values, class Make>
void check_refused(const Values& values, const Make& make, const std::string& words) {
  const std::string line = refusal([&] { make(values); });
  CAPTURE(words);
  CAPTURE(line);
  CHECK(line.find(words) != std::string::npos);
  CHECK(line.find('\n') == std::string::npos);
}

SceneField field_of(const IndexFieldValues& values) {
  return made_of(values, [](const Keys& keys, const IndexFieldValues& all) {
    return make_scene_field(keys, all, {.reach = 10});
  });
}

/// Returns values of these kinds of fields, each by its word.
template <class... Kind>
IndexFieldValues fields(const Kind&... kind) {
  IndexFieldValues values;
  values.field = {Kind::word...};
  ((values.of<Kind>() = kind), ...);
  return values;
}

/// A temporary file with the lifetime of the object.
struct TemporaryFile {
  explicit TemporaryFile(const std::string& text)
      : path((std::filesystem::temp_directory_path() /
              ("flatspeckle-scene-" + std::to_string(::getpid())))
                 .string()) {
    std::ofstream(path) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path); }
  std::string path;
};

TraceValues trace_values() {
  TraceValues values;
  values.stops.max_length = 5;
  return values;
}

void refuse_trace(const TraceValues& values, const std::string& words) {
  check_refused(
      values, [](const TraceValues& all) { make_trace_scene(all); }, words);
}

/// Returns a beam through fog in a box onto an area detector.
RenderValues render_values() {
  RenderValues values;
  values.stage.stage_box = {-1, -1, 0, 1, 1, 4};
  values.stage.medium = {.mu_s = 0.4, .mu_a = 0.1};
  values.lights.beam_light = {0, 0, 0, 0, 0, 1, 0.3, 2};
  values.sensors.sensor = {AreaValues::word};
  values.sensors.pixels = {4, 3};
  values.sensors.of<AreaValues>() = {.sensor_at = {0, 0, 4}, .sensor_size = {1, 0.8}};
  return values;
}

void refuse_render(const RenderValues& values, const std::string& words) {
  check_refused(
      values, [](const RenderValues& all) { check(make_render_scene(all), {}); }, words);
}

}  // namespace

TEST_CASE("fields from values: index, scale and symmetry of each kind") {
  const Vec3 x(0.1, 0.2, 0.3);
  const SceneField glass = field_of(fields(HomogeneousValues{.index = 1.5}));
  CHECK(index_at(glass, x) == 1.5);
  CHECK(glass.scale == 0);
  const SceneField ball = field_of(fields(LuneburgValues{.radius = 2, .centre = {0, 0, 1}}));
  CHECK(index_at(ball, {0, 0, 1}) == doctest::Approx(std::sqrt(2)));
  CHECK(index_at(ball, {0, 0, 4}) == 1);
  CHECK(ball.rim->radius == 2);
  CHECK(ball.symmetry == Symmetry::sphere);
  const SceneField eye = field_of(fields(FisheyeValues{.radius = 0.5}));
  CHECK(index_at(eye, {0, 0, 0.5}) == doctest::Approx(1));
  ParabolicValues parabolic;
  parabolic.alpha = 0.5;
  const SceneField guide = field_of(fields(parabolic));
  CHECK(guide.scale == 2);
  CHECK(guide.symmetry == Symmetry::round_guide);
  const SceneField ramp = field_of(fields(LinearValues{.index = 1.2, .slope = {0, 0.5, 0}}));
  CHECK(index_at(ramp, x) == doctest::Approx(1.3));
  CHECK((ramp.axis - Vec3::UnitY()).norm() == 0);
  const SceneField step = field_of(fields(TanhValues{.index_low = 1.1, .index_high = 1.4}));
  CHECK(index_at(step, Vec3::Zero()) == doctest::Approx(1.25));
  UltrasoundValues sound;
  sound.amplitude = 0.1;
  sound.sound_wavenumber = 4;
  sound.sound_phase = pi / 3;
  CHECK(index_at(field_of(fields(sound)), Vec3::Zero()) == doctest::Approx(1.05));
  const TemporaryFile blobs("x,y,z,height,width\n0,0,0,0.2,1\n0,0,9,0.1,0.25\n");
  const SceneField cloud = field_of(fields(BlobsValues{.blobs = blobs.path}));
  CHECK(index_at(cloud, Vec3::Zero()) == doctest::Approx(1.2));
  CHECK(cloud.scale == 0.25);
}

TEST_CASE("fields from values: sums with one medium or a background") {
  const TanhValues step{.index_low = 1.1, .index_high = 1.4};
  const LinearValues ramp{.slope = {0, 0, 0.1}};
  const SceneField both = field_of(fields(HomogeneousValues{.index = 1.3}, step));
  CHECK(index_at(both, Vec3::Zero()) == doctest::Approx(1.3 + 0.15));
  IndexFieldValues without = fields(ramp, step);
  without.of<HomogeneousValues>().index = 1.3;  // the background
  CHECK(index_at(field_of(without), {0, 0, 0.01}) == doctest::Approx(1.451 + 0.003).epsilon(1e-3));
  const SceneField ball = field_of(fields(LuneburgValues{}, ramp));
  CHECK(index_at(ball, {0, 0, 2}) == doctest::Approx(1.2));
  CHECK(ball.scale == 1);
  CHECK(ball.symmetry == Symmetry::none);
}

TEST_CASE("fields from values: invalid ones are rejected by their keys") {
  const auto refused = [](const IndexFieldValues& values, const std::string& words) {
    check_refused(values, field_of, words);
  };
  IndexFieldValues glass;
  glass.field = {"glass"};
  refused(glass, "field = glass: must be one of homogeneous luneburg");
  refused(fields(LuneburgValues{}, FisheyeValues{}),
          "field = luneburg fisheye: must have at most one medium");
  refused(fields(LinearValues{}, LinearValues{}), "field = linear: must not be given twice");
  refused(fields(HomogeneousValues{.index = 0}), "index = 0: must be positive");
  refused(fields(LuneburgValues{.radius = -1}), "radius = -1: must be positive");
  refused(fields(LuneburgValues{.centre = {0, 1}}), "centre = 0 1: must be three numbers");
  refused(fields(SechValues()), "alpha is not given");
  refused(fields(BlobsValues{}), "blobs is not given");
  refused(fields(BlobsValues{.blobs = "absent.csv"}), "blobs = absent.csv: no such file");
  refused(fields(TanhValues{.index_low = 1, .index_high = 2, .ramp_axis = {0, 0, 0}}),
          "ramp_axis = 0 0 0: must not be 0");
  IndexFieldValues other;
  other.of<FisheyeValues>().radius = 2;
  refused(other, "radius = 2: is a key of luneburg, fisheye only");
  IndexFieldValues sum = fields(LuneburgValues{}, LinearValues{.slope = {0, 0, 0.1}});
  sum.of<HomogeneousValues>().index = 1.3;
  refused(sum, "index = 1.3: is a key of");
}

TEST_CASE("rays from values: agree with the focus of a Luneburg ball") {
  TraceValues values = trace_values();
  values.field = fields(LuneburgValues{});
  values.starts.origin = {0, 0, -1};
  values.starts.beam_radius = 0.9;
  values.stops.stop_plane = {0, 0, 1, 0, 0, 1};
  values.path_points = 7;
  const TraceScene scene = make_trace_scene(values);
  for (const TracedRay& ray : trace_rays(scene)) {
    CHECK((ray.end.x - Vec3::UnitZ()).norm() < 1e-7);
    CHECK(ray.end.optical_path == doctest::Approx(pi / 2 + 1).epsilon(1e-8));
    CHECK(ray.status == RayStatus::surface);
    CHECK(ray.path.size() == 7);
  }
  CHECK(describe(scene.steps) == "sharma, tolerance 1e-10, steps up to 0.3125");
}

TEST_CASE("rays from values: every light with every integrator") {
  for (const char* light : {"line", "square", "disk", "beam", "fan", "cone"})
    for (const char* integrator : {"sharma", "yoshida4", "leapfrog"}) {
      TraceValues values = trace_values();
      values.starts.light = light;
      values.starts.ray_count = 5;
      values.stops.integrator = integrator;
      values.stops.step = 0.01;
      values.field = fields(LinearValues{.slope = {0, 0, 0.1}});
      CAPTURE(light);
      CAPTURE(integrator);
      const auto rays = trace_rays(make_trace_scene(values));
      CHECK(rays.size() == 5);
      for (const TracedRay& ray : rays) {
        CHECK(ray.end.arc_length == doctest::Approx(5));
        CHECK((ray.last.transverse - ray.first.transverse).norm() < 1e-10);
        CHECK(ray.index_mismatch < 1e-4);
      }
    }
}

TEST_CASE("curves from values: both arcs in a fisheye") {
  TraceValues values = trace_values();
  values.stops.max_length = 8;
  values.field = fields(FisheyeValues{});
  values.curves = {.connect = {0.3, 0.1, -0.6, -0.2, 0.7, 0.9}, .trials = 300};
  const TraceScene scene = make_trace_scene(values);
  const FoundConnections found = find_connections(scene, 1);
  REQUIRE(found.curves.size() == 2);
  CHECK(found.curves[0].curve.optical_path + found.curves[1].curve.optical_path ==
        doctest::Approx(2 * pi));
  const auto rays = rays_along(scene, found);
  CHECK((rays[1].end.x - Vec3(-0.2, 0.7, 0.9)).norm() < 1e-6);
}

TEST_CASE("rays from values: invalid ones are rejected by their keys") {
  TraceValues values;
  refuse_trace(values, "max_length is not given");
  values = trace_values();
  values.starts.half_angle = 0.3;
  refuse_trace(values, "half_angle = 0.3: is a key of fan, cone only");
  values = trace_values();
  values.starts.light = "laser";
  refuse_trace(values, "light = laser: must be one of line square disk beam fan cone");
  values = trace_values();
  values.starts.light = "fan";
  values.starts.half_angle = 4;
  refuse_trace(values, "half_angle = 4: must be in (0, 3.14159");
  values = trace_values();
  values.starts.across = {0, 0, 1};
  refuse_trace(values, "across = 0 0 1: must not be parallel to the direction");
  values = trace_values();
  values.stops.stop_sphere = {0, 0, 1, -1};
  refuse_trace(values, "stop_sphere, radius = -1: must be positive");
  values = trace_values();
  values.stops.stop_box = {1, 1, 1, 0, 0, 0};
  refuse_trace(values, "stop_box = 1 1 1 0 0 0: must have its low corner first");
  values = trace_values();
  values.path_points = 1;
  refuse_trace(values, "path_points = 1");
  values = trace_values();
  values.curves.trials = 10;
  refuse_trace(values, "trials = 10: is a key of connect only");
  values.curves.connect = {0, 0, 0, 0, 0, 1};
  values.stops.tolerance = 1e-6;
  refuse_trace(values, "tolerance = 1e-06: is a key of rays only");
  const TemporaryFile still("x,y,z,dx,dy,dz\n0,0,0,0,0,0\n");
  values = trace_values();
  values.starts.rays = still.path;
  refuse_trace(values, "direction of ray 0 = 0 0 0: must not be 0");
  values.starts.origin = {0, 0, 1};
  refuse_trace(values, "direction of ray 0");
}

TEST_CASE("pictures from values: agree with the scene by hand") {
  const RenderScene made = make_render_scene(render_values());
  const Stage stage{.boundary = Box{{-1, -1, 0}, {1, 1, 4}}, .medium = {.mu_s = 0.4, .mu_a = 0.1}};
  const AreaDetector area{{0, 0, 4}, {0, 1, 0}, 1, 0.8, {4, 3}, pi / 2};
  const RenderScene by_hand{.field = Homogeneous{},
                            .step = made.step,
                            .max_length = made.max_length,
                            .stage = stage,
                            .lights = {BeamLight{Vec3::Zero(), Vec3::UnitZ(), 0.3, 2}},
                            .sensors = {area}};
  std::vector<Complex> sums[2];
  for (int i = 0; i < 2; ++i) {
    const RenderJob job = render_job(i == 0 ? made : by_hand, make_render_request({}), 1);
    sums[i].resize(job.batches.size);
    job.batches.run(0, sums[i]);
  }
  CHECK(sums[0] == sums[1]);
}

TEST_CASE("stages from values: bodies, a silent wave and steps") {
  RenderValues values = render_values();
  values.field = fields(LuneburgValues{.radius = 0.5, .centre = {0, 0, 2}});
  values.stage.index_around = 1.2;
  values.stage.body_medium.mu_s = 3;
  const RenderScene ball = make_render_scene(values);
  REQUIRE(ball.stage.bodies.size() == 1);
  CHECK(ball.stage.bodies[0].medium.mu_s == 3);
  CHECK(ball.stage.excess_around == doctest::Approx(0.2));
  CHECK(ball.step == doctest::Approx(0.13));  // chosen
  values.stage.plain_bodies.ball = {0, 0, 2, 0.2, 1.5, 3, 1, 0.5, 0, 0, 3, 0.4, 1.1, 0, 0, 0};
  values.stage.plain_bodies.block = {-0.9, -0.9, 1.1, 0.9, 0.9, 2.9, 1.3, 0, 2, 0};
  const Stage nested = make_render_scene(values).stage;  // from the largest to the smallest
  REQUIRE(nested.parts() == 5);
  CHECK(nested.field_part() == 2);
  CHECK(nested.excess_in(1) == doctest::Approx(0.3));
  CHECK(nested.excess_in(3) == doctest::Approx(0.1));
  CHECK(nested.medium_in(4).mu_s == 3);
  CHECK(Regions(nested).at({0, 0, 2}) == 4);
  values = render_values();
  UltrasoundValues sound;
  sound.index = 1.33;
  sound.amplitude = 0;
  sound.sound_wavenumber = 4;
  values.field = fields(sound);
  const RenderScene silent = make_render_scene(values);
  CHECK(std::get<Homogeneous>(silent.field).n_excess == doctest::Approx(0.33));
}

TEST_CASE("pictures from values: invalid ones are rejected by their keys") {
  const auto refused = [](const auto& change, const std::string& words) {
    RenderValues values = render_values();
    change(values);
    refuse_render(values, words);
  };
  CHECK(refusal([] { check(make_render_scene(render_values()), {}); }).empty());
  refused([](auto& v) { v.stage.stage_box.clear(); }, "stage is not given");
  refused([](auto& v) { v.stage.stage_sphere = {0, 0, 0, 9}; }, "give one stage");
  refused([](auto& v) { v.stage.body_sphere = {0, 0, 2, 1.5}; }, "inside of the stage");
  refused([](auto& v) { v.stage.index_around = 1.3; }, "index_around = 1.3: is a key of a body");
  refused([](auto& v) { v.stage.body_medium.mu_s = 1; }, "body_mu_s = 1: is a key of a body");
  using Numbers = std::vector<double>;
  const auto refused_ball = [&](const Numbers& ball, const std::string& words) {
    refused([&](auto& v) { v.stage.plain_bodies.ball = ball; }, words);
  };
  refused_ball({0, 0, 2, 0.5, 1.4, 1, 0}, "must be 8 numbers for each");
  refused_ball({0, 0, 2, 1.5, 1.4, 1, 0, 0}, "must be inside of the stage");
  refused_ball({0, 0, 2, 0, 1.4, 1, 0, 0}, "ball, radius = 0: must be positive");
  refused_ball({0, 0, 2, 0.5, 0, 1, 0, 0}, "ball, index = 0: must be positive");
  refused_ball({0, 0, 2, 0.5, 1.4, -1, 0, 0}, "ball, mu_s = -1: must not be negative");
  refused_ball({0, 0, 2, 0.5, 1.4, 1, -1, 0}, "ball, mu_a = -1: must not be negative");
  refused_ball({0, 0, 2, 0.5, 1.4, 1, 0, 1}, "ball, g = 1: must be between -1 and 1");
  refused([](auto& v) { v.stage.plain_bodies.block = {0, 0, 2, 0.5, 0.5, 1, 1.4, 1, 0, 0}; },
          "must have its low corner first");
  refused([](auto& v) { v.stage.plain_bodies.ball = {0, 0, 2, 0.5, 1.4, 1e7, 0, 0}; },
          "ball, mu_s = 1e+07: is too dense");
  refused([](auto& v) { v.stage.medium.mu_s = -1; }, "mu_s = -1: must not be negative");
  refused([](RenderValues& v) { v.stage.medium.of<HgPhase>().g = 0.5; },
          "g = 0.5: is a key of henyey_greenstein");
  refused([](auto& v) { v.stage.medium = {.mu_s = {}, .mu_a = {}, .phase = "rayleigh"}; },
          "phase = rayleigh: is a key of");
  refused(
      [](auto& v) {
        v.stage.medium.mu_s = 1e7;
        v.stage.medium.mu_a = 0;
      },
      "too dense");
  refused([](auto& v) { v.max_length = 9; }, "max_length = 9: is a key of a field that bends rays");
  refused([](auto& v) { v.random_phase = true; }, "random_phase: requires field = ultrasound");
  refused([](auto& v) { v.path_bins = {2, 1, 5}; }, "path_bins = 2 1 5: must have a first length");
  refused([](auto& v) { v.path_bins = {1, 2, 1.5}; }, "path_bins = 1 2 1.5: must have a whole");
  refused(
      [](auto& v) {
        v.path_bins = {1, 2, 90'000};
        v.sensors.pixels = {10, 10};
      },
      "pixels x path_bins");
  refused([](auto& v) { v.lights = {}; }, "light is not given");
  refused([](auto& v) { v.lights.point_light = {0, 0, 1}; }, "must be 4 numbers for each");
  refused([](auto& v) { v.lights.point_light = {0, 0, 1, 0}; }, "point_light, power = 0");
  refused([](auto& v) { v.lights.point_light = {0, 0, 1, 1e200}; }, "to 1e50");
  refused([](auto& v) { v.lights.beam_light[6] = 0; }, "beam_light, radius = 0");
  refused([](auto& v) { v.lights.face_light = {0, 0, 0, 0.1, -1}; }, "face_light, radiance = -1");
  refused([](auto& v) { v.lights.environment = 0; }, "environment = 0: must be positive");
}

TEST_CASE("sensors from values: invalid ones are rejected by their keys") {
  const auto refused = [](const auto& change, const std::string& words) {
    RenderValues values = render_values();
    change(values.sensors);
    refuse_render(values, words);
  };
  const auto camera = [](SensorValues& sensor) -> CameraValues& {
    sensor = {};
    return sensor.of<CameraValues>() = {.sensor_at = {0, 0, 3.9}, .field_of_view = {1}};
  };
  refused([](auto& s) { s.sensor = {"eye"}; }, "sensor = eye: must be one of camera area");
  refused([](auto& s) { s.pixels = {4}; }, "pixels = 4: must be 2 numbers for each: columns rows");
  refused([](auto& s) { s.pixels = {0, 3}; }, "pixels = 0: must be from 1 to 16384");
  refused([](auto& s) { s.template of<AreaValues>().sensor_at.clear(); }, "sensor_at is not given");
  refused([](auto& s) { s.template of<AreaValues>().acceptance = {2}; },
          "acceptance = 2: must be in");
  refused([](auto& s) { s.template of<CameraValues>().field_of_view = {1}; },
          "field_of_view = 1: is a key of camera only");
  refused([&](auto& s) { camera(s).field_of_view = {4}; }, "field_of_view = 4: must be in");
  refused([&](auto& s) { camera(s).focus_distance = {1}; }, "focus_distance = 1: is a key of");
  refused([&](auto& s) { camera(s).lens_radius = {0.1}; }, "focus_distance is not given");
  refused(
      [](auto& s) {
        s = {};
        s.sensor = {DirectionalValues::word};
        s.template of<DirectionalValues>().half_angle = {0};
      },
      "half_angle = 0: must be in");
  const auto faces = [](SensorValues& sensors) -> AreaValues& {
    sensors = {.sensor = {AreaValues::word, AreaValues::word}};
    return sensors.of<AreaValues>() = {.sensor_at = {0, 0, 0, 0, 0, 4}, .sensor_size = {1, 0.8}};
  };
  refused(
      [&](auto& s) {
        faces(s).acceptance = {1, 1, 1};
      },
      "acceptance: must have one value for all sensors, or one for each of the 2");
  refused([&](auto& s) { faces(s), s.sensor_name = {"a"}; }, "must have one name for each sensor");
  refused([&](auto& s) { faces(s), s.sensor_name = {"a", "a"}; }, "must not be repeated");
  refused(
      [&](auto& s) {
        faces(s), s.sensor_name = {"a", "b/c"};
      },
      "sensor_name = b/c: must consist");
  refused([](auto& s) { s.sensor_name = {"a"}; }, "sensor_name = a: is a key of several sensors");
}

TEST_CASE("sensors from values: shared and separate values of keys") {
  RenderValues values = render_values();
  values.sensors = {.sensor = {AreaValues::word, CameraValues::word, AreaValues::word},
                    .sensor_name = {"back", "eye", "front"},
                    .pixels = {4, 3}};
  values.sensors.of<AreaValues>() = {
      .sensor_at = {0, 0, 0, 0, 0, 2, 0, 0, 4}, .sensor_size = {1, 0.8}, .acceptance = {0.1, 1, 1}};
  values.sensors.of<CameraValues>() = {.sensor_at = {0, 0, 0, 0, 0, 2, 0, 0, 4},
                                       .field_of_view = {1.2}};
  const RenderScene scene = make_render_scene(values);
  REQUIRE(scene.sensors.size() == 3);
  const auto& back = std::get<AreaDetector>(scene.sensors[0]);
  const auto& front = std::get<AreaDetector>(scene.sensors[2]);
  CHECK(back.centre == Vec3::Zero());
  CHECK(front.centre == Vec3(0, 0, 4));
  CHECK(back.acceptance == 0.1);
  CHECK(front.acceptance == 1);
  CHECK(front.pixels.count() == 12);
  CHECK(std::get<Camera>(scene.sensors[1]).x == Vec3(0, 0, 2));
  CHECK(sensor_name(scene, 1) == "eye");
}

TEST_CASE("methods from values: invalid ones are rejected by their keys") {
  CHECK(make_render_request({.method = "light"}).method == RenderMethod::light);
  const auto refused = [](const RenderRequestValues& values, const std::string& words) {
    check_refused(
        values, [](const RenderRequestValues& v) { make_render_request(v); }, words);
  };
  refused({.method = "magic"}, "method = magic: must be one of");
  refused({.method = "photon_map"}, "photon_map is a baseline of `bench error`");
  refused({.max_scatterings = -1}, "max_scatterings = -1: must be from 0");
}

}  // namespace flatspeckle::grin::test_scene_values

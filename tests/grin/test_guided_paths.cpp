// Counted paths that are guided to sensors far from the light, and turned about it: against paths
// that are not.
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/scenes/render_scenes.h"
#include "grin/media/scattering/labelled_media.h"
#include "grin/render/methods/forward_light.h"
#include "grin/render/methods/guided_walk.h"
#include "grin/render/methods/tracer.h"
#include "tests/grin/forward_powers.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::tests::test_guided_paths {

namespace {

using std::numbers::pi;

ScatteringMedium scatterers(double mu_s, double mu_a, double g) {
  return {mu_s, mu_a, SpacePhaseFunction{HgPhase{g}}};
}

/// Returns two layers in a narrow box under absorbing air: paths often meet the sides.
RenderScene narrow_layers() {
  RenderScene scene{};
  scene.step = 1;
  scene.max_length = 1e9;
  scene.stage = {.boundary = Box{{-3, -3, -0.2}, {3, 3, 4}},
                 .medium = {.mu_a = 0.3},
                 .bodies = {{Box{{-3, -3, 0}, {3, 3, 1}}, scatterers(2, 0.05, 0.5), 0.5},
                            {Box{{-3, -3, 1}, {3, 3, 4}}, scatterers(1, 0.02, 0), 0.3}}};
  scene.lights = {BeamLight{{0.5, 0, -0.2}, Vec3::UnitZ(), 0.2, 2}};
  scene.sensors = {RadialDetector{{-1.2, 0, -0.2}, 0.5, 2, 0.9, {}}};
  scene.bins.moments = true;
  scene.bins.decay = std::make_shared<const FieldDecay>(
      FieldDecay{.delays = {0.05, 0.5}, .diffusion = {0, 1, 0.3}});
  return scene;
}

/// Means and standard errors of all sums of a kernel, and of the powers by termination.
struct Tallies {
  std::vector<double> value, error;
};
Tallies tallied(const RenderScene& scene, const PathKernel& kernel, int pixels, int paths) {
  constexpr int batches = 64;
  const auto count = static_cast<std::size_t>(pixels) * scene.bins.sums();
  std::vector<double> sum(count + EnergyBalance::size), square = sum;
  for (int batch = 0; batch < batches; ++batch) {
    std::vector<Complex> own(count + EnergyBalance::size);
    Film film(pixels, scene.bins, std::span(own).first(count));
    TransportCounts counts;
    RandomStream random(7, 0, static_cast<std::uint64_t>(batch));
    kernel(paths / batches, random, film, counts, nullptr);
    film.energy.add_to(std::span(own).subspan(count));
    for (std::size_t i = 0; i < own.size(); ++i) {
      const double value = own[i].real() / (paths / batches);
      sum[i] += value / batches;
      square[i] += value * value / batches;
    }
  }
  Tallies found{sum, {}};
  for (std::size_t i = 0; i < sum.size(); ++i)
    found.error.push_back(std::sqrt(std::max(0.0, square[i] - sum[i] * sum[i]) / (batches - 1)));
  return found;
}

struct SpaceAndTransport {
  std::shared_ptr<const Transport> transport;
  std::shared_ptr<const Space> space;

  explicit SpaceAndTransport(const RenderScene& scene)
      : transport(transport_of(scene, {RenderMethod::forward}, RenderMethod::forward)),
        space(make_space(scene.field, scene.stage,
                         {scene.step, scene.max_length, Spreading::none})) {}
  PathKernel plain() const { return forward_kernel(transport, space, std::nullopt, false); }
};

void check_agreement(const RenderScene& scene, int pixels, int guided_paths, int plain_paths,
                     double largest_error) {
  const SpaceAndTransport in(scene);
  const auto guide = PathGuide::of(scene, 1);
  REQUIRE(guide.has_value());
  const PathKernel guided =
      guided_kernel(std::make_shared<const PathGuide>(*guide), in.transport, in.space);
  const Tallies one = tallied(scene, guided, pixels, guided_paths),
                other = tallied(scene, in.plain(), pixels, plain_paths);
  for (std::size_t i = 0; i < one.value.size(); ++i) {
    CAPTURE(i);
    CAPTURE(one.value[i]);
    CAPTURE(other.value[i]);
    const double error = std::hypot(one.error[i], other.error[i]);
    CAPTURE(error);
    CHECK(std::abs(one.value[i] - other.value[i]) <= 4 * error + 1e-12);
  }
  CHECK(one.error[0] < largest_error * one.value[0]);
  CHECK(other.error[0] < 2 * largest_error * other.value[0]);
}

}  // namespace

TEST_CASE("level layers: parts, planes and indices follow from the bodies") {
  const RenderScene scene = narrow_layers();
  const auto layers = LevelLayers::of(scene.stage, 2, 0);
  REQUIRE(layers.has_value());
  REQUIRE(layers->layers().size() == 4);
  const double highest[] = {0, 1, 4, 4}, excess[] = {0, 0.5, 0.3, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(layers->layers()[i].high == highest[i]);
    CHECK(layers->layers()[i].excess == excess[i]);
  }
  CHECK(layers->first() == 1);
  CHECK(layers->last() == 2);
  CHECK(!LevelLayers::of(scene.stage, 0, 0));
  Stage with_ball = scene.stage;
  with_ball.bodies.push_back({Sphere{{0, 0, 2}, 0.5}, {}, 0.0});
  CHECK(!LevelLayers::of(with_ball, 2, 0));
}

TEST_CASE("ring target: shares of circles integrate to its area") {
  const RingTarget ring{3, 0.7, 1.1, false};
  const double area =
      flatspeckle::tests::integral([&](double r) { return 2 * pi * r * ring.share(r); }, 1.5, 4.5);
  CHECK(area == doctest::Approx(pi * (1.1 * 1.1 - 0.7 * 0.7)).epsilon(1e-4));
}

TEST_CASE("guided paths between reflecting sides: all tallies agree with unguided paths") {
  check_agreement(narrow_layers(), 2, is_night ? 400000 : 16000, is_night ? 4000000 : 160000,
                  is_night ? 0.03 : 0.1);
}

TEST_CASE(
    "guided paths from a fibre to both faces: powers and derivatives agree with unguided paths") {
  RenderScene scene{};
  scene.step = 1;
  scene.max_length = 1e9;
  scene.stage = {.boundary = Box{{0, -3, -3}, {2, 3, 3}}, .medium = scatterers(2, 0.1, 0.6)};
  scene.lights = {FibreLight{{1.5, 0, 0}, -Vec3::UnitX(), 0.1, 0.3}};
  scene.sensors = {RadialDetector{{2, 1, 1}, 0.6, 2, pi / 2, {0.3, 0.6}},
                   RadialDetector{{0, 0, -1.5}, 0.5, 1, pi / 2, {}}};
  scene.bins.derivatives = 3;
  check_agreement(scene, 3, is_night ? 400000 : 16000, is_night ? 4000000 : 160000,
                  is_night ? 0.03 : 0.1);
}

TEST_CASE("field correlation: derivatives by diffusion equal differences of the same paths") {
  const RenderScene scene = narrow_layers();
  const int first = scene.bins.first_decay(), derivatives = scene.bins.first_decay_derivative();
  const auto decayed = [&](std::size_t part, double change) {
    RenderScene moved = scene;
    FieldDecay decay = *scene.bins.decay;
    decay.diffusion[part] += change;
    moved.bins.decay = std::make_shared<const FieldDecay>(decay);
    return tallied(moved, SpaceAndTransport(moved).plain(), 2, 6400).value;
  };
  const auto found = decayed(0, 0);
  for (const std::size_t part : {1u, 2u}) {
    constexpr double apart = 1e-4;
    const auto above = decayed(part, apart), below = decayed(part, -apart);
    for (std::size_t t = 0; t < 2; ++t)
      CHECK(found[derivatives + part * 2 + t] ==
            doctest::Approx((above[first + t] - below[first + t]) / (2 * apart)).epsilon(1e-5));
  }
}

/// The reference values are by harmonics (reflectance), with an error of 7e-4. Rows: distance,
/// power, g1 at 1e-3 and at 1e-2.
TEST_CASE("guided paths in tissue: power and field correlation on far disks agree with harmonics") {
  struct Expected {
    double distance, power, early, late;
  };
  const Expected expected[] = {{10, 6.81782e-4, 0.9130, 0.4506},
                               {20, 1.47102e-5, 0.8168, 0.1749},
                               {30, 5.51492e-7, 0.7273, 0.06547}};
  for (const Expected& row : expected) {
    if (!is_night && row.distance > 10) continue;
    CAPTURE(row.distance);
    RenderScene scene = bench::tissue_disk(row.distance);
    scene.bins.decay =
        std::make_shared<const FieldDecay>(FieldDecay{.delays = {1e-3, 1e-2}, .diffusion = {0, 1}});
    const Powers found = powers(scene, is_night ? 200000 : 1000);
    const double area = pi * 1.5 * 1.5, total = area * found.found.mean.value[0].real(),
                 error = area * found.found.mean.error[0];
    CAPTURE(total);
    CAPTURE(error);
    CHECK(std::abs(total - row.power) < 4 * error + 1e-3 * row.power);
    CHECK(error < (is_night ? 0.006 : 0.15) * row.power);
    for (std::size_t t = 0; t < 2; ++t) {
      const double g1 = found.found.decay->mean.value[t].real(),
                   own = found.found.decay->mean.error[t], value = t == 0 ? row.early : row.late;
      CAPTURE(g1);
      CHECK(std::abs(g1 - value) < 4 * own + 1e-3 * value);
      CHECK(own < (is_night ? 0.006 : 0.15) * value);
    }
  }
}

TEST_CASE("path guide: wide or near sensors and other lights are left to unguided paths") {
  RenderScene layers = narrow_layers();
  layers.bins.decay = nullptr;
  CHECK(PathGuide::of(layers, 1).has_value());
  CHECK(!PathGuide::of(layers, 1e-5));  // many paths reach the sensor
  RenderScene beyond = layers;
  beyond.sensors = {RadialDetector{{-2.2, 0, -0.2}, 0.5, 2, 0.9, {}}};
  CHECK(!PathGuide::of(beyond, 1));  // paths to it cannot be turned
  RenderScene tilted = layers;
  tilted.lights = {BeamLight{{0.5, 0, -0.2}, Vec3(0.6, 0, 0.8), 0.1}};
  CHECK(!PathGuide::of(tilted, 1));
  RenderScene voxels = layers;
  voxels.stage.medium =
      labelled_medium({Vec3::Constant(-3), Vec3::Constant(3), {2, 2, 2}, {0, 0, 0, 0, 0, 0, 0, 1}},
                      {1, 0, 0.5, 3, 1, 0}, "label_media");
  CHECK(!PathGuide::of(voxels, 1));
}

}  // namespace flatspeckle::grin::tests::test_guided_paths

#include <numeric>

#include <doctest/doctest.h>

#include "bench/oracles/lamp_map.h"
#include "grin/render/pictures/map_datasets.h"
#include "grin/render/pictures/render_datasets.h"
#include "tests/grin/furnace_scenes.h"

namespace flatspeckle::grin::tests::test_light_map {

namespace {

constexpr double pi = std::numbers::pi;

struct Mapped {
  Estimate fluence, absorbed, energy;
};

/// Renders the map alone, without a sensor.
Mapped mapped(RenderScene scene, const LightMap& map, double samples) {
  scene.sensors.clear();
  scene.map = map;
  const RenderJob job = render_job(scene, {}, 1);
  const RunState state = run_render(job, samples);
  CHECK(transport_counts(job, state.sums).lost_values == 0);
  const std::size_t first = job.first_of_map();
  return {fluence(state.sums, first, map), absorbed(state.sums, first, map),
          energy_result(job, state.sums).value()};
}

RenderScene lamp_in(const Surface& boundary, const ScatteringMedium& medium) {
  return scene_in(Homogeneous{}, {boundary, medium}, PointLight{Vec3::Zero()}, whole_face());
}

double largest_error(const Estimate& estimate) {
  double largest = 0;
  for (std::size_t i = 0; i < estimate.value.size(); ++i)
    largest = std::max(largest, estimate.error[i] / estimate.value[i].real());
  return largest;
}

void check_cells(const Estimate& found, const std::vector<double>& expected) {
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CAPTURE(i);
    CAPTURE(found.value[i].real());
    CAPTURE(found.error[i]);
    CAPTURE(expected[i]);
    CHECK(std::abs(found.value[i].real() - expected[i]) < 4 * found.error[i] + 1e-12 * expected[i]);
  }
}

/// Returns the squared index at x, at one phase of sound.
double square_index(const RenderScene& scene, const Vec3& x, double phase) {
  const Stage& stage = scene.stage;
  if (const Part part = Regions(stage).at(x); part != stage.field_part())
    return std::pow(1 + stage.excess_in(part), 2);
  return std::visit(
      [&]<class F>(const F& field) {
        if constexpr (std::same_as<F, StandingWave>)
          return std::pow(index(field.frozen(std::cos(phase)), x), 2);
        else
          return std::pow(index(field, x), 2);
      },
      scene.field);
}

/// Returns 4 pi times the mean squared index of each cell, over a lattice and, for sound, its
/// phases.
std::vector<double> mean_square_index(const RenderScene& scene, const BoxCells& cells) {
  const int nodes = is_night ? 60 : 30;
  const int phases = scene.random_phase ? 8 : 1;
  std::vector<double> sums(static_cast<std::size_t>(grin::cells(cells)));
  std::vector<int> points(sums.size());
  for (int i = 0; i < nodes * nodes * nodes; ++i) {
    const Vec3 place(i % nodes, i / nodes % nodes, i / nodes / nodes);
    const Vec3 x = (2 * place + Vec3::Ones()) / nodes - Vec3::Ones();
    const auto cell = static_cast<std::size_t>(cells.cell_at(x));
    for (int phase = 0; phase < phases; ++phase)
      sums[cell] += square_index(scene, x, (phase + 0.5) * pi / phases) / phases;
    ++points[cell];
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] *= 4 * pi / points[i];
  return sums;
}

}  // namespace

TEST_CASE(
    "oracle of a point source in an infinite medium: limits and power agree with closed forms") {
  using oracles::point_source_fluence;
  // unscattered light nearby; diffusion far away, D = 1/3 where little is absorbed
  const double near = 1e-6, far = 40;
  CHECK(point_source_fluence(2, 0.5, near) ==
        doctest::Approx(1 / (4 * pi * near * near)).epsilon(1e-5));
  CHECK(point_source_fluence(1, 1 - 1e-9, far) ==
        doctest::Approx(3 * std::exp(-far * std::sqrt(3e-9)) / (4 * pi * far)).epsilon(1e-6));
  // mu_a times its integral over space is the power
  double power = 0;
  const double step = 0.002;
  for (double r = step / 2; r < 60; r += step)
    power += step * 4 * pi * r * r * 0.3 * point_source_fluence(1, 0.7, r);
  CHECK(power == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("fluence around a point light: agrees with transport theory") {
  for (const double albedo : {0.3, 0.9}) {
    const RenderScene scene = oracles::lamp_map(albedo);
    const Mapped found = mapped(scene, *scene.map, is_night ? 400000 : 100000);
    const auto expected = oracles::lamp_fluence(albedo);
    check_cells(found.fluence, expected);
    std::vector<double> absorbed = expected;
    for (double& value : absorbed) value *= 1 - albedo;
    check_cells(found.absorbed, absorbed);
    // between 3 and 4 mean free paths
    if (albedo > 0.5) CHECK(found.fluence.error[2] < (is_night ? 0.01 : 0.02) * expected[2]);
  }
}

TEST_CASE("map without sensors: absorbed power agrees with the energy balance") {
  const ScatteringMedium medium = fog(1, 0.4, 0.7);
  RenderScene scene = lamp_in(unit_box(), medium);
  scene.stage.bodies.push_back({Sphere{Vec3(0.2, 0, 0.3), 0.4}, fog(0, 2, 0)});
  scene.stage.bodies.push_back({Sphere{Vec3(0.3, 0, 0.3), 0.2}, fog(1, 3, 0), 0.2});
  scene.stage.bodies.push_back({Box{{-0.9, -0.9, -0.9}, {-0.3, 0.5, 0.5}}, fog(2, 0.5, 0), 0.1});
  scene.field = Homogeneous{0.4};
  const BoxCells cells(std::get<Box>(unit_box()), {5, 4, 3});
  const Mapped found = mapped(scene, cells, is_night ? 20000 : 8000);
  double power = 0, variance = 0;
  for (std::size_t i = 0; i < found.absorbed.value.size(); ++i) {
    power += cells.volume(0) * found.absorbed.value[i].real();
    variance += std::pow(cells.volume(0) * found.absorbed.error[i], 2);
  }
  const auto share = [&](Termination termination) {
    return found.energy.value[static_cast<std::size_t>(termination)].real();
  };
  const double tallied = share(Termination::absorbed_stage) + share(Termination::absorbed_body);
  CHECK(share(Termination::emitted) == doctest::Approx(1).epsilon(1e-12));
  CHECK(share(Termination::absorbed_body) > 0.05);
  CHECK(share(Termination::scattered) > 0.05);
  double all = 0;
  for (std::size_t termination = 1; termination < EnergyBalance::size; ++termination)
    all += found.energy.value[termination].real();
  CHECK(all == doctest::Approx(1).epsilon(1e-12));
  CHECK(std::abs(power - tallied) < 4 * std::sqrt(variance));
  CHECK(std::sqrt(variance) < (is_night ? 0.03 : 0.05));
}

TEST_CASE("fluence of a beam in absorbers: agrees with Beer and Lambert, with and without a grid") {
  ScatteringMedium even, by_grid;
  even.mu_a = 1.3;
  by_grid.mu_a = 1.3;
  const FieldGrid grid{Vec3(-1, -1, -1), Vec3(2, 2, 2), {2, 2, 2}};
  by_grid.density =
      std::make_shared<DensityGrid>(grid, std::vector<double>{0, 1, 0, 1, 0, 1, 0, 1});
  const RingCells slices(Vec3(0, 0, -1), Vec3(0, 0, 1), 0.5, {1, 10});
  const auto fluence_of = [&](const ScatteringMedium& medium) {
    RenderScene scene = scene_in(Homogeneous{}, {unit_box(), medium},
                                 BeamLight{{0, 0, -1}, {0, 0, 1}, 0.25, 3}, whole_face());
    return mapped(scene, slices, 40000).fluence;
  };
  // means over slices: integral of the optical depth 1.3 d or 1.3 d^2/4 over a slice
  const auto expected = [&](const auto& depth) {
    std::vector<double> means(10);
    for (int i = 0; i < 10000; ++i) {
      const double d = 2 * (i + 0.5) / 10000;
      means[static_cast<std::size_t>(i / 1000)] += 3 / (pi * 0.25) * std::exp(-depth(d)) / 1000;
    }
    return means;
  };
  check_cells(fluence_of(even), expected([](double d) { return 1.3 * d; }));
  check_cells(fluence_of(by_grid), expected([](double d) { return 1.3 * d * d / 4; }));
}

// The white furnace (C24): the radiance is n^2 in every direction, the fluence 4 pi n^2.
TEST_CASE("fluence in the white furnace: agrees with 4 pi n^2, in every field") {
  const BoxCells cells(std::get<Box>(unit_box()), {3, 2, 2});
  for (const NamedRender& named : furnaces(fog(0.6, 0, 0.5))) {
    CAPTURE(named.name);
    const bool is_sound = named.scene.random_phase;
    const Estimate found = mapped(named.scene, cells, is_sound ? 40000 : 10000).fluence;
    CHECK(largest_error(found) < 0.1);
    check_cells(found, mean_square_index(named.scene, cells));
  }
  for (const NamedRender& named : furnaces_of_bodies(fog(0.6, 0, 0.5))) {
    CAPTURE(named.name);
    const Estimate found = mapped(named.scene, cells, is_night ? 20000 : 10000).fluence;
    CHECK(largest_error(found) < (is_night ? 0.1 : 0.15));
    check_cells(found, mean_square_index(named.scene, cells));
  }
}

}  // namespace flatspeckle::grin::tests::test_light_map

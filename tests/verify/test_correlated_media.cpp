// Correlated disks (conventions, C16): Monte Carlo with and without their structure factor against
// tabulated exact covariances, at packing 0.03, 0.1 and 0.2.
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/keys/csv.h"
#include "flatland/media/structure_factor.h"
#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"

namespace flatspeckle::test_correlated_media {

namespace {

struct Exact {
  std::vector<double> angle, intensity, error;
};

Exact tabulated(double count, double index) {
  const Table table = read_csv(FLATSPECKLE_DATA "/reference/correlated/intensity.csv");
  Exact exact;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.column("count")[row] != count || table.column("index")[row] != index) continue;
    exact.angle.push_back(table.column("angle")[row]);
    exact.intensity.push_back(table.column("intensity")[row]);
    exact.error.push_back(table.column("intensity_error")[row]);
  }
  REQUIRE(exact.angle.size() == 15);
  return exact;
}

Scene disks(int count, const std::string& index, const std::string& structure,
            const std::vector<double>& views) {
  SceneSpec spec;
  spec.width = 12;
  spec.depth = 8;
  spec.scatterer = "tm";
  spec.radius = 0.15915494309189535;
  spec.index = index;
  spec.count = count;
  spec.structure = structure;
  spec.view_angles = views;
  return make_scene(spec);
}

/// Measures the structure factor of random sequential placements in the scene's box.
StructureFactor measured_structure(const Scene& scene) {
  MeasuredStructureFactor measured(scene.domain, 2.1 * scene.k, 0.3);
  for (std::uint64_t r = 0; r < 1000; ++r) {
    RandomStream random(1, 0, r);
    std::vector<Vec> centres;
    for (const auto& disk : draw_placement(scene.domain, scene.scatterer, scene.placement, random))
      centres.push_back(disk.position);
    measured.add(centres);
  }
  return {"measured", measured.shell_means([](double q) { return q; }), measured.values()};
}

/// Deviation mc / exact - 1 over the detection directions: its RMS, from which the noise of the
/// exact values is subtracted, and its mean.
struct Deviation {
  double rms = 0, mean = 0, mean_error = 0;

  Deviation(const Scene& scene, const Exact& exact) {
    const auto plan = mc::make_plan(scene, mc::ReversedPaths::automatic);
    const FieldJob job = mc::covariance_job(scene, plan, 1);
    RunOptions options;
    options.stop.samples = 200'000;
    RunState state;
    run_batches(job.batches, options, state);
    const auto found = field_moments(job, state.sums).covariance;
    const auto views = static_cast<double>(exact.angle.size());
    double squares = 0, noise = 0;
    for (std::size_t v = 0; v < exact.angle.size(); ++v) {
      const double deviation = found.value[v].real() / exact.intensity[v] - 1;
      mean += deviation / views;
      squares += deviation * deviation;
      noise += std::pow(exact.error[v] / exact.intensity[v], 2);
    }
    rms = std::sqrt(std::max(0.0, squares - noise) / views);
    mean_error = std::sqrt(noise) / views;
    MESSAGE("count ", scene.placement.mean_count, ": RMS ", 100 * rms, " %, mean ", 100 * mean,
            " +- ", 100 * mean_error, " %");
  }
};

/// Returns the deviation allowed with the structure factor. It is due to recurrent scattering
/// (first term) and to refraction at the faces and local fields, which are of the order of the
/// relative shift of the wavenumber.
double allowance(const Scene& scene) {
  const auto& medium = scene.medium;
  return 2 / (scene.k * medium.mean_free_path()) + 2 * medium.k_shift / scene.k;
}

}  // namespace

TEST_CASE("correlated disks: with the structure factor the covariance agrees with exact values") {
  for (const int count : {36, 121, 241}) {
    const Exact exact = tabulated(count, 1.2);
    const Scene scene = disks(count, "1.2", "hard_disks", exact.angle);
    const Deviation with(scene, exact), without(disks(count, "1.2", "none", exact.angle), exact);
    CHECK(with.rms < allowance(scene));
    CHECK(without.rms > 2 * with.rms);
  }
}

TEST_CASE("correlated disks, packing 0.1: the measured S reduces the RMS deviation threefold") {
  const Exact exact = tabulated(121, 1.2);
  Scene scene = disks(121, "1.2", "none", exact.angle);
  const Deviation without(scene, exact);
  scene.medium = correlated_medium(scene.medium, scene.k, measured_structure(scene));
  CHECK(without.rms > 3 * Deviation(scene, exact).rms);
}

TEST_CASE(
    "correlated disks, index 1.05: the remaining deviation scales with the shift of the "
    "wavenumber") {
  const Exact exact = tabulated(121, 1.05);
  const Scene scene = disks(121, "1.05", "hard_disks", exact.angle);
  const Deviation with(scene, exact), without(disks(121, "1.05", "none", exact.angle), exact);
  // The noise of the exact values is as large as the remaining deviation.
  CHECK(with.rms < allowance(scene) + 4 * with.mean_error);
  CHECK(without.rms > 8 * with.rms);
}

}  // namespace flatspeckle::test_correlated_media

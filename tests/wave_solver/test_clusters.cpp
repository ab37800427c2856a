// Compares the T-matrix of a cluster with the exact solution of all its disks and checks energy
// conservation and reciprocity.

#include <cmath>

#include <doctest/doctest.h>

#include "bench/scenes/copied_cluster.h"
#include "core/error.h"
#include "reference.h"
#include "wave_solver/clusters/cluster_solution.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave::test_clusters {

namespace {

constexpr double k = two_pi, gap = 0.5;

Placement five_disks() {
  const std::vector<Vec> centres{{0, 0.1}, {0.7, 0.2}, {-0.6, 0.4}, {0.1, -0.7}, {-0.5, -0.4}};
  Placement placement;
  for (std::size_t j = 0; j < centres.size(); ++j) {
    Scatterer disk = reference_scatterer(j % 2 == 0 ? "TM15" : "D");
    disk.radius = 0.15 + 0.03 * static_cast<double>(j);
    placement.push_back({centres[j], disk});
  }
  return placement;
}

std::vector<ClusterPlace> six_places(double pitch) {
  return bench::rows_of_places(2, 3, pitch);
}

// Returns w_n of ClusterTMatrix.
double wave_size(const Mode& mode) {
  return static_cast<double>(mode.weight) * (mode.order == 0 ? std::sqrt(2.0) : 1.0);
}

std::vector<Complex> full_far_fields(const Placement& placement, const std::vector<double>& lights,
                                     const std::vector<double>& views) {
  const auto solution = solve(placement, k, lights, {.sensors = {}, .diagnose = false});
  std::vector<Complex> fields;
  for (std::size_t light = 0; light < lights.size(); ++light)
    for (const double view : views) fields.push_back(solution.far_field(view, light));
  return fields;
}

}  // namespace

TEST_CASE("cluster T-matrix: conserves energy and is reciprocal") {
  const auto cluster = cluster_t_matrix(five_disks(), k, gap);
  const std::size_t size = cluster.modes.size();
  REQUIRE(size == 2 * static_cast<std::size_t>(cluster.order) + 1);
  // T + T^H + 2 T^H T = 0 for lossless scatterers, in unscaled waves
  std::vector<Complex> t = cluster.response;
  double asymmetry = 0, loss = 0;
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i)
      t[i + size * j] *= wave_size(cluster.modes[i]) * wave_size(cluster.modes[j]);
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i) {
      asymmetry = std::max(asymmetry, std::abs(t[i + size * j] - t[j + size * i]));
      Complex sum = t[i + size * j] + std::conj(t[j + size * i]);
      for (std::size_t l = 0; l < size; ++l)
        sum += 2.0 * std::conj(t[l + size * i]) * t[l + size * j];
      loss = std::max(loss, std::abs(sum));
    }
  CHECK(asymmetry < 1e-12);
  CHECK(loss < 1e-11);
}

TEST_CASE("copies of a cluster: far fields agree with the exact solution of all disks") {
  const auto disks = five_disks();
  const auto cluster = cluster_t_matrix(disks, k, gap);
  const std::vector<double> lights{0.3, -2.0}, views{0, 0.5, 1.9, -0.8, 3.0};
  for (const auto& places :
       {std::vector<ClusterPlace>{{{0.4, 2}, 1.1}}, six_places(2 * cluster.radius + gap)}) {
    const auto expected = full_far_fields(bench::copies(disks, places), lights, views);
    const ClusterSolution solution(cluster, places, lights);
    CHECK(relative_distance(solution.fields(far_views(views)), expected) < 1e-9);
    CHECK(solution.diagnosis().residual < 1e-11);
  }
}

// T has few orders and can be inverted, so that all methods apply.
TEST_CASE(
    "copies of a cluster far apart: dense and fast methods agree with the solution of all disks") {
  const auto disks = five_disks();
  constexpr double wide = 2, tolerance = 1e-9;
  const auto cluster = cluster_t_matrix(disks, k, wide, tolerance);
  const auto places = six_places(2 * cluster.radius + wide);
  const std::vector<double> lights{0.3, -2.0}, views{0, 0.5, 1.9, -0.8, 3.0};
  const auto expected = full_far_fields(bench::copies(disks, places), lights, views);
  for (const Method method : {Method::dense, Method::fast}) {
    const ClusterSolution solution(cluster, places, lights, {tolerance, {}, true, method});
    CHECK(relative_distance(solution.fields(far_views(views)), expected) < 1e-9);
    CHECK(solution.diagnosis().residual < tolerance);
    CHECK(solution.equations().have_inverse());
  }
}

TEST_CASE("copies of a cluster: distances below the gap of the T-matrix are rejected") {
  const auto cluster = cluster_t_matrix(five_disks(), k, gap);
  const auto near = six_places(2 * cluster.radius + 0.9 * gap);
  CHECK_THROWS_AS(ClusterSolution(cluster, near, {0}), InputError);
  CHECK_THROWS_AS(cluster_t_matrix(five_disks(), k, 0), InputError);
  CHECK_THROWS_AS(cluster_t_matrix(five_disks(), k, 1e-3), InputError);
}

}  // namespace flatspeckle::wave::test_clusters

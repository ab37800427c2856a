#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include "bench/scenes/copied_cluster.h"
#include "bench/stability/extreme_rows.h"
#include "wave_solver/clusters/cluster_solution.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::bench {

namespace {

using namespace wave;

constexpr double k = 2 * std::numbers::pi, tolerance = 1e-9;

// Four disks about the origin, the farthest point of them at 3 radii.
Placement four_disks(double radius, Complex index) {
  const Scatterer disk{.kind = Scatterer::Kind::tm, .radius = radius, .index = index};
  const double out = 2 * radius;
  return {{{out, 0}, disk}, {{0, out}, disk}, {{-out, 0}, disk}, {{0, -0.9 * out}, disk}};
}

// Two copies whose circles are a gap apart, in the circle's radii.
Finding against_all_disks(double radius, Complex index, double gap, double limit) {
  const Placement disks = four_disks(radius, index);
  const auto cluster = cluster_t_matrix(disks, k, gap * 3 * radius, tolerance);
  const auto places = rows_of_places(1, 2, 2 * cluster.radius + 1.01 * cluster.gap);
  const std::vector<double> lights{0.3, 1.9};
  std::vector<View> views;
  for (int i = 0; i < 36; ++i) views.push_back(far_view(k * i / 36));
  const SolveOptions options{.tolerance = tolerance, .sensors = {}, .diagnose = false};
  const auto whole = solve(copies(disks, places), k, lights, options).fields(views);
  const auto found = ClusterSolution(cluster, places, lights, options).fields(views);
  return {relative_difference(found, whole), limit};
}

}  // namespace

std::vector<ExtremeCase> wave_cluster_extremes() {
  ExtremeRows rows("wave_solver");
  for (const auto& [name, radius, index, gap] :
       {std::tuple("k a 1e-3", 1e-3 / k, Complex(1.5), 0.5),
        {"k a 1", 1 / k, 1.5, 0.5},
        {"k a 10", 10 / k, 1.5, 0.5},
        {"k a 1, gap of 0.1 radii", 1 / k, 1.5, 0.1},
        {"k a 1, index 10", 1 / k, 10, 0.5},
        {"k a 1, index 1 + 1e-8", 1 / k, 1 + 1e-8, 0.5},
        {"k a 1, index 0.1 + 5i", 1 / k, {0.1, 5}, 0.5}})
    rows.add("two copies of a cluster, disks of " + std::string(name), "all disks in one",
             [a = radius, n = index, g = gap] { return against_all_disks(a, n, g, 1e-7); });
  rows.add_refused("copies closer than the gap of their T-matrix", "gap", [] {
    const auto cluster = cluster_t_matrix(four_disks(1 / k, 1.5), k, 0.5, tolerance);
    ClusterSolution(cluster, rows_of_places(1, 2, 2 * cluster.radius), {0});
  });
  return std::move(rows).rows();
}

}  // namespace flatspeckle::bench

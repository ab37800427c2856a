// One whole realization by the dense path, from drawing the placement to 64 far fields of 64
// lights, beside one LU factorisation (LAPACK's zgetrf) of a matrix of the same size, taken in turn
// on one thread; then ensembles over threads. Medians of `rounds`.
//
//   bench_dense [rounds]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <vector>

#include <omp.h>

#include "bench/measure/median.h"
#include "core/run/stopwatch.h"
#include "flatland/placement/placement.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/solutions/wave_solution.h"

using namespace flatspeckle;
using namespace flatspeckle::wave;
using bench::median;

namespace {

constexpr double k = 2 * std::numbers::pi;
constexpr double tolerance = 1e-6;
const SolveOptions options{
    .tolerance = tolerance, .sensors = {}, .diagnose = false, .method = Method::dense};

struct Case {
  const char* name;
  Scatterer scatterer;
  double density;  // per square wavelength
};

struct Times {
  std::vector<double> drawn, system, matrix, solved, fields, whole, lu;
};

std::vector<double> angles(double first, double last) {
  std::vector<double> values;
  for (int i = 0; i < 64; ++i) values.push_back(first + (last - first) * i / 63);
  return values;
}

Placement draw(const Case& scene, std::size_t count, std::uint64_t number) {
  const double side = std::sqrt(static_cast<double>(count) / scene.density);
  RandomStream random(1, static_cast<std::uint64_t>(Stream::placement), number);
  PlacementRule rule;
  rule.mean_count = static_cast<double>(count);
  rule.count = count;
  if (scene.scatterer.is_disk()) rule.kind = PlacementRule::Kind::hard_disk;
  rule.min_gap = 0.1 * scene.scatterer.disk_radius();
  return draw_placement({Domain::Kind::box, side, side}, scene.scatterer, rule, random);
}

double lu_seconds(Entries matrix, std::size_t unknowns) {
  const auto n = static_cast<lapack_int>(unknowns);
  std::vector<lapack_int> pivots(unknowns);
  const Stopwatch clock;
  LAPACKE_zgetrf(LAPACK_COL_MAJOR, n, n, matrix.data(), n, pivots.data());
  return clock.seconds();
}

std::size_t realization(const Case& scene, std::size_t count, std::uint64_t number, Times& times) {
  const auto lights = angles(-1, 1);
  std::vector<View> views;
  for (double angle : angles(-1.2, 1.2)) views.push_back(far_view(angle));
  Stopwatch clock, all;
  const auto lap = [&](std::vector<double>& part) {
    part.push_back(clock.seconds());
    clock = Stopwatch();
  };
  const Placement placement = draw(scene, count, number);
  lap(times.drawn);
  const TMatrixSystem system(placement, k, tolerance);
  lap(times.system);
  auto matrix = system.matrix();
  lap(times.matrix);
  const auto basis = light_basis(lights, k, enclosing_circle(placement), tolerance);
  DenseFactor factor(std::move(matrix), system.unknowns());
  const auto beta = factor.solve(system.right_sides(basis.angles));
  lap(times.solved);
  const auto plan = make_field_plan(lights, views, k, enclosing_circle(placement), tolerance);
  clock = Stopwatch();
  scattered_fields(placement, k, plan, options);
  times.whole.push_back(times.drawn.back() + clock.seconds());
  times.lu.push_back(lu_seconds(system.matrix(), system.unknowns()));
  return system.unknowns();
}

void one_thread(int rounds) {
  Scatterer disk{.kind = Scatterer::Kind::tm, .radius = 1 / k, .index = 1.5};
  std::printf(
      "one realization, 64 lights, 64 views, one thread, milliseconds (medians of %d)\n"
      "%-10s %9s | %8s %8s %8s %8s | %8s %8s | %s\n",
      rounds, "scatterers", "unknowns", "draw", "orders", "matrix", "solve", "whole", "zgetrf",
      "whole / zgetrf");
  for (const auto& [scene, unit] :
       {std::pair{Case{"points", {}, 10}, 1.0}, std::pair{Case{"disks", disk, 2}, 13.0}})
    for (const double target : {1000.0, 2000.0, 4000.0}) {
      Times times;
      std::size_t unknowns = 0;
      for (int round = 0; round < rounds; ++round)
        unknowns = realization(scene, static_cast<std::size_t>(target / unit), round, times);
      std::vector<double> ratio;
      for (std::size_t i = 0; i < times.lu.size(); ++i)
        ratio.push_back(times.whole[i] / times.lu[i]);
      std::printf("%-10s %9zu | %8.2f %8.2f %8.2f %8.2f | %8.2f %8.2f | %.2f\n", scene.name,
                  unknowns, 1e3 * median(times.drawn), 1e3 * median(times.system),
                  1e3 * median(times.matrix), 1e3 * median(times.solved), 1e3 * median(times.whole),
                  1e3 * median(times.lu), median(ratio));
    }
}

double ensemble_seconds(const Case& scene, std::size_t count, int placements, int threads) {
  const auto plan =
      make_field_plan({0, 0.1}, {far_view(0.1), far_view(3)}, k, {{0, 0}, 100}, tolerance);
  const Stopwatch clock;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (int number = 0; number < placements; ++number)
    scattered_fields(draw(scene, count, number), k, plan, options);
  return clock.seconds();
}

// Multiplications in registers: what the machine gives to more threads at best.
double spin_seconds(int threads) {
  const Stopwatch clock;
  double sum = 0;
#pragma omp parallel for num_threads(threads) reduction(+ : sum)
  for (int part = 0; part < 16; ++part) {
    double x = 1 + 1e-9 * part;
    for (int i = 0; i < 20'000'000; ++i) x = x * 1.0000001 + 1e-9;
    sum += x;
  }
  return sum > 0 ? clock.seconds() : 0;
}

void ensembles(int rounds) {
  const int most = omp_get_num_procs();
  std::printf("\nensembles: placements per second; speed of %d threads over one\n", most);
  for (const std::size_t count : {31, 250, 1000}) {
    const int placements = count == 31 ? 8000 : count == 250 ? 400 : 32;
    std::vector<double> one, all, spin;
    for (int round = 0; round < rounds; ++round) {
      one.push_back(ensemble_seconds({"points", {}, 1}, count, placements, 1));
      all.push_back(ensemble_seconds({"points", {}, 1}, count, placements, most));
      spin.push_back(spin_seconds(1) / spin_seconds(most));
    }
    std::printf("%5zu points: %9.1f/s on one, %9.1f/s on %d: %.2f   (register arithmetic: %.2f)\n",
                count, placements / median(one), placements / median(all), most,
                median(one) / median(all), median(spin));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  blas_single_thread();
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  one_thread(rounds);
  omp_set_num_threads(threads);
  ensembles(rounds);
}

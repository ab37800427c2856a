// The fast direct solver on resonant points at fixed density: what a factorization and a solve for
// many lights cost, and how well they solve. usage: bench_fast_direct [tolerance] [N ...]
// CPU seconds are comparable between machines only as ratios; run on one thread (OMP_NUM_THREADS=1)
// for those, on all for wall seconds.
#include "wave_solver/skeletons/fast_direct.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <sys/resource.h>
#include <vector>

#include "core/numbers/random.h"
#include "core/run/stopwatch.h"
#include "wave_solver/equations/t_matrix_system.h"

using namespace flatspeckle;

namespace {

constexpr double two_pi = 2 * std::numbers::pi;
constexpr double density = 10;  // per square wavelength
constexpr std::size_t lights = 64;

Placement points(std::size_t count) {
  RandomStream random(1, 1, 0);
  const double side = std::sqrt(static_cast<double>(count) / density);
  Placement placement(count);
  for (auto& placed : placement)
    placed.position = {side * random.uniform(), side * random.uniform()};
  return placement;
}

// ||M x - b|| / ||b|| of the first light, over a thousand of the equations.
double sampled_residual(const wave::TMatrixSystem& system, const std::vector<Complex>& x,
                        const std::vector<Complex>& b) {
  constexpr std::size_t samples = 1024, chunk = 64;
  const std::size_t n = system.unknowns();
  std::vector<std::size_t> all(n), rows(chunk);
  for (std::size_t i = 0; i < n; ++i) all[i] = i;
  std::vector<Complex> columns(n * chunk);
  double left = 0, given = 0;
  for (std::size_t first = 0; first < samples; first += chunk) {
    for (std::size_t i = 0; i < chunk; ++i) rows[i] = (first + i) * n / samples;
    system.entries(all, rows, columns.data(), n);
    for (std::size_t i = 0; i < chunk; ++i) {
      Complex sum = -b[rows[i]];
      for (std::size_t j = 0; j < n; ++j) sum += product(columns[i * n + j], x[j]);
      left += std::norm(sum);
      given += std::norm(b[rows[i]]);
    }
  }
  return std::sqrt(left / given);
}

double peak_gigabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1e-6 * static_cast<double>(usage.ru_maxrss);
}

void print_levels(const wave::FastDirect::Statistics& statistics) {
  std::printf("    boxes: mean unknowns -> mean skeleton (largest)\n");
  for (const auto& level : statistics.levels) {
    const auto boxes = static_cast<double>(level.boxes);
    std::printf("    %6zu: %7.1f -> %7.1f (%zu)\n", level.boxes,
                static_cast<double>(level.unknowns) / boxes,
                static_cast<double>(level.skeleton) / boxes, level.largest);
  }
  std::printf("      root: %zu\n", statistics.root);
}

// Returns CPU seconds of the factorization.
double measure(std::size_t count, double tolerance) {
  const wave::TMatrixSystem system(points(count), two_pi, 1e-12);
  const wave::FastDirect direct(system, tolerance);
  std::vector<double> angles(lights);
  for (std::size_t i = 0; i < lights; ++i) angles[i] = two_pi * static_cast<double>(i) / lights;
  const auto sides = system.right_sides(angles);
  auto x = sides;
  const Stopwatch watch;
  direct.solve(x);
  const double solved = watch.seconds();
  const auto& statistics = direct.statistics();
  std::printf("%8zu %10.2f %10.2f %12.2f %8.3f %8.3f %10.1e\n", count, statistics.cpu_seconds,
              statistics.wall_seconds, solved, 1e-9 * statistics.bytes, peak_gigabytes(),
              sampled_residual(system, x, sides));
  print_levels(statistics);
  return statistics.cpu_seconds;
}

}  // namespace

int main(int argc, char** argv) {
  const double tolerance = argc > 1 ? std::atof(argv[1]) : 1e-6;
  std::vector<std::size_t> counts;
  for (int i = 2; i < argc; ++i) counts.push_back(std::strtoul(argv[i], nullptr, 10));
  if (counts.empty()) counts = {4096, 16384, 65536};
  std::printf("tolerance %g; %zu lights; resonant points, %g per square wavelength\n", tolerance,
              lights, density);
  std::printf("%8s %10s %10s %12s %8s %8s %10s\n", "N", "factor/CPU", "factor/s", "solve/s", "GB",
              "peak GB", "residual");
  double before = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double seconds = measure(counts[i], tolerance);
    if (i > 0)
      std::printf("    growth: N^%.2f\n",
                  std::log(seconds / before) / std::log(static_cast<double>(counts[i]) /
                                                        static_cast<double>(counts[i - 1])));
    before = seconds;
  }
}

// What `flatspeckle solve` costs from start to file, on one thread, beside LAPACK's zgetrf of a
// matrix of the same size, taken in turn: user CPU seconds, medians of `rounds`. Start-up and file
// are those of one point under as many lights and views.
//
//   OMP_NUM_THREADS=1 bench_solve_program PROGRAM [rounds]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "bench/measure/median.h"
#include "core/numbers/blas.h"
#include "core/numbers/complex.h"
#include "core/numbers/random.h"

using namespace flatspeckle;
using bench::median;

namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double user_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return seconds(usage.ru_utime);
}

std::string angles(double first, double last, int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i)
    text += std::to_string(first + (last - first) * i / std::max(1, count - 1)) + ',';
  text.back() = ']';
  return text;
}

struct Task {
  std::size_t points;
  std::string solver;
  int lights = 64;
};

std::vector<std::string> words(const std::string& program, const Task& task,
                               const std::string& out) {
  const std::string side = std::to_string(std::sqrt(static_cast<double>(task.points) / 10));
  return {program,          "solve",
          "--width",        side,
          "--depth",        side,
          "--scatterer",    "point",
          "--count",        std::to_string(task.points),
          "--placement",    "poisson",
          "--tolerance",    "1e-6",
          "--solver",       task.solver,
          "--light_angles", angles(-1, 1, task.lights),
          "--view_angles",  angles(-1.2, 1.2, 64),
          "--threads",      "1",
          "--out",          out};
}

// Of the program.
double program_seconds(const std::string& program, const Task& task) {
  const auto folder = std::filesystem::temp_directory_path();
  auto arguments = words(program, task, folder / "bench_solve_program.h5");
  std::vector<char*> pointers;
  for (std::string& word : arguments) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
    execv(program.c_str(), pointers.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child || status != 0)
    throw std::runtime_error(program + " failed");
  return seconds(usage.ru_utime);
}

double lu_seconds(std::size_t size) {
  const auto n = static_cast<lapack_int>(size);
  std::vector<Complex> matrix(size * size);
  RandomStream random(1, 0, size);
  for (Complex& value : matrix) value = {random.uniform() - 0.5, random.uniform() - 0.5};
  std::vector<lapack_int> pivots(size);
  const double start = user_seconds();
  LAPACKE_zgetrf(LAPACK_COL_MAJOR, n, n, matrix.data(), n, pivots.data());
  return user_seconds() - start;
}

void dense(const std::string& program, int rounds) {
  std::printf("%-8s %10s %10s %10s %8s %8s\n", "points", "program", "start, file", "zgetrf",
              "ratio", "without");
  for (const std::size_t points : {1000, 2000, 4000}) {
    std::vector<double> whole, lu, start, ratio, without;
    for (int round = 0; round < rounds; ++round) {
      start.push_back(program_seconds(program, {1, "dense"}));
      whole.push_back(program_seconds(program, {points, "dense"}));
      lu.push_back(lu_seconds(points));
      ratio.push_back(whole.back() / lu.back());
      without.push_back((whole.back() - start.back()) / lu.back());
    }
    std::printf("%-8zu %10.4f %10.4f %10.4f %8.2f %8.2f\n", points, median(whole), median(start),
                median(lu), median(ratio), median(without));
  }
}

void fast(const std::string& program, int rounds) {
  std::printf("%-8s %10s %10s %8s\n", "points", "1 light", "64 lights", "ratio");
  for (const std::size_t points : {4096, 16384}) {
    std::vector<double> one, many, ratio;
    for (int round = 0; round < rounds; ++round) {
      one.push_back(program_seconds(program, {points, "fast", 1}));
      many.push_back(program_seconds(program, {points, "fast", 64}));
      ratio.push_back(many.back() / one.back());
    }
    std::printf("%-8zu %10.3f %10.3f %8.2f\n", points, median(one), median(many), median(ratio));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fputs("usage: bench_solve_program PROGRAM [rounds]\n", stderr), 2;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  blas_single_thread();
  dense(argv[1], rounds);
  fast(argv[1], rounds);
}

#include "bench/error/error_imaging.h"

#include <cmath>

#include <omp.h>

#include "bench/error/error_measure.h"
#include "bench/scenes/blinking_frames.h"
#include "bench/scenes/imaged_points.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::bench {

namespace {

constexpr double fewest_paths = 1000;

Estimate correlations(const mc::LineScene& line, double paths, std::uint64_t seed) {
  return mc::predicted(line, static_cast<std::uint64_t>(paths), seed, 1, "")->correlation;
}

ErrorReference reference_of(const mc::LineScene& line) {
  constexpr double paths = 400000;
  constexpr std::uint64_t seed = 1000;
  const Estimate many = correlations(line, paths, seed);
  return {many.value, relative_error(many), "400,000 paths"};
}

/// RMS over some runs.
ErrorPoint point(const mc::LineScene& line, const ErrorReference& reference, double paths) {
  constexpr std::uint64_t runs = 16;
  double squares = 0;
  const double start = thread_cpu_seconds();
  for (std::uint64_t seed = 1; seed <= runs; ++seed)
    squares += std::pow(relative_distance(correlations(line, paths, seed).value, reference), 2);
  const double error = std::sqrt(squares / runs);
  return {(thread_cpu_seconds() - start) / runs, paths, error, error / std::sqrt(2.0 * runs)};
}

ErrorCurve by_paths(double cpu_seconds) {
  constexpr std::size_t fewest = 3;
  omp_set_num_threads(1);
  const mc::LineScene line = imaged_points();
  const ErrorReference reference = reference_of(line);
  ErrorCurve curve{"image, C_I of pairs", "paths", reference.how, reference.relative_error, {}};
  curve.is_monte_carlo = false;  // a ratio
  const double start = thread_cpu_seconds();
  for (double paths = fewest_paths, spent = 0;
       curve.points.size() < fewest || 3 * spent < cpu_seconds; paths *= 2) {
    curve.points.push_back(point(line, reference, paths));
    spent = thread_cpu_seconds() - start;
    if (curve.points.back().error < 2 * reference.relative_error) break;
  }
  set_plain_slope(curve);
  return curve;
}

/// Patterns of sources by frames, over some seeds.
ErrorPoint patterns_point(std::size_t frames) {
  constexpr unsigned seeds = 8;
  BlinkingScene scene{.frames = frames};
  scene.noise.photons = 20;
  double squares = 0, spent = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const BlinkingFrames made = blinking_frames(scene, seed);
    const double start = thread_cpu_seconds();
    const auto found = mc::unmixed(made.frames, {scene.noise, 40, scene.brightness.size()});
    spent += thread_cpu_seconds() - start;
    squares += std::pow(pattern_error(made, found.factors.pattern), 2);
  }
  const double error = std::sqrt(squares / seeds);
  return {spent / seeds, static_cast<double>(frames), error, error / std::sqrt(2.0 * seeds)};
}

ErrorCurve by_frames(double cpu_seconds) {
  constexpr std::size_t fewest = 3, first = 16, most = 1024;
  ErrorCurve curve{"image, patterns of sources", "frames", "the patterns that were mixed", 0, {}};
  curve.is_monte_carlo = false;
  const double start = thread_cpu_seconds();
  for (std::size_t frames = first;
       frames <= most &&
       (curve.points.size() < fewest || 3 * (thread_cpu_seconds() - start) < cpu_seconds);
       frames *= 2)
    curve.points.push_back(patterns_point(frames));
  set_plain_slope(curve);
  return curve;
}

}  // namespace

std::vector<ErrorRun> imaging_error_runs() {
  return {{"image, C_I of pairs", "paths", by_paths, true},
          {"image, patterns of sources", "frames", by_frames, false}};
}

}  // namespace flatspeckle::bench

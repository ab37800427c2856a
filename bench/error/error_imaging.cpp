#include <cmath>

#include "bench/error/error_modules.h"
#include "bench/scenes/blinking_frames.h"
#include "bench/scenes/imaged_points.h"

namespace flatspeckle::bench {

namespace {

Estimate correlations(const mc::LineScene& line, double paths, std::uint64_t seed) {
  return mc::predicted(line, static_cast<std::uint64_t>(paths), seed, 1, "").correlation;
}

ErrorReference reference_of(const mc::LineScene& line) {
  constexpr double paths = 400000;
  constexpr std::uint64_t seed = 1000;
  const Estimate many = correlations(line, paths, seed);
  return {many.value, relative_error(many), "400,000 paths"};
}

ErrorCurve pairs_by_paths(double cpu_seconds) {
  const mc::LineScene line = imaged_points();
  const ErrorReference reference = reference_of(line);
  ErrorCurve curve{"image, C_I of pairs", "paths", reference.how, reference.relative_error, {}};
  measure_points(curve, cpu_seconds, [&, paths = 500.0]() mutable {
    paths *= 2;
    return rms_point(16, [&](unsigned seed) {
      return timed_run(paths, [&] {
        return std::pow(relative_distance(correlations(line, paths, seed).value, reference), 2);
      });
    });
  });
  return curve;
}

/// Error of the separated source patterns for a number of frames.
ErrorPoint patterns_point(std::size_t frames) {
  BlinkingScene scene{.frames = frames};
  scene.noise.photons = 20;
  return rms_point(8, [&](unsigned seed) {
    const BlinkingFrames made = blinking_frames(scene, seed);
    return timed_run(static_cast<double>(frames), [&] {
      const auto found =
          mc::separated_sources(made.frames, {scene.noise, 40, scene.brightness.size()});
      return std::pow(pattern_error(made, found.factors.pattern), 2);
    });
  });
}

ErrorCurve by_frames(double cpu_seconds) {
  constexpr std::size_t most = 1024;
  ErrorCurve curve{"image, patterns of sources",
                   "frames",
                   "the patterns of which the frames are mixtures",
                   0,
                   {}};
  measure_points(curve, cpu_seconds, [frames = std::size_t{8}]() mutable {
    frames *= 2;
    return frames <= most ? std::optional(patterns_point(frames)) : std::nullopt;
  });
  return curve;
}

}  // namespace

std::vector<ErrorRun> imaging_error_runs() {
  return {{"image, C_I of pairs", "paths", pairs_by_paths, true},
          {"image, patterns of sources", "frames", by_frames, false}};
}

}  // namespace flatspeckle::bench

#include <cmath>
#include <numeric>
#include <string>

#include "bench/error/error_modules.h"
#include "bench/scenes/blinking_frames.h"
#include "bench/scenes/imaged_points.h"
#include "bench/scenes/speckle_frames.h"
#include "mc/imaging/retrieval/contrast_map.h"
#include "mc/imaging/simulated/picture_prediction.h"

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

Estimate separations(const mc::PictureScene& scene, double paths, std::uint64_t seed) {
  mc::PictureTask task;
  task.prediction_paths = static_cast<std::uint64_t>(paths);
  task.seed = seed;
  return mc::predicted_speckle(scene, task).correlation;
}

ErrorCurve separations_by_paths(double cpu_seconds) {
  const mc::PictureScene scene = imaged_in_space();
  constexpr double many_paths = 2e6;
  const Estimate many = separations(scene, many_paths, 1000);
  const ErrorReference reference{many.value, relative_error(many), "2,000,000 paths"};
  ErrorCurve curve{"image in space, C_I", "paths", reference.how, reference.relative_error, {}};
  measure_points(curve, cpu_seconds, [&, paths = 2500.0]() mutable {
    paths *= 2;
    return rms_point(16, [&](unsigned seed) {
      return timed_run(paths, [&] {
        return std::pow(relative_distance(separations(scene, paths, seed).value, reference), 2);
      });
    });
  });
  return curve;
}

/// Error of K^2, averaged over a map, for frames of two patterns.
ErrorPoint contrast_point(std::size_t count) {
  constexpr double expected = 0.5;
  return rms_point(8, [&](unsigned seed) {
    const Frames frames = mixed_speckle(count, 48, 2, seed);
    return timed_run(static_cast<double>(count), [&] {
      const auto map = mc::contrast_map(frames, {.window = 9});
      const double mean = std::reduce(map.square.begin(), map.square.end()) /
                          static_cast<double>(map.square.size());
      return std::pow(mean / expected - 1, 2);
    });
  });
}

/// Lack of correlation of a picture with the object, by the number of frames.
ErrorPoint picture_point(std::size_t count) {
  constexpr std::size_t side = 96, lags = 20;
  const auto letter = sparse_letter(lags);
  return rms_point(4, [&](unsigned seed) {
    const Frames frames = shifted_speckle(count, side, letter, lags, seed);
    return timed_run(static_cast<double>(count), [&] {
      const auto statistics = mc::picture_statistics(frames, 0, count, lags, {});
      const auto found = mc::retrieved_picture(statistics.autocorrelation, {lags, lags},
                                               {.starts = 4, .iterations = 200});
      return std::pow(1 - mc::best_alignment(letter, found.picture, {lags, lags}).correlation, 2);
    });
  });
}

ErrorCurve by_count(const std::string& name, const std::string& how, std::size_t most,
                    ErrorPoint (*point)(std::size_t), double cpu_seconds) {
  ErrorCurve curve{name, "frames", how, 0, {}};
  measure_points(curve, cpu_seconds, [most, point, count = std::size_t{1}]() mutable {
    count *= 2;
    return count <= most ? std::optional(point(count)) : std::nullopt;
  });
  return curve;
}

ErrorCurve contrast_by_frames(double cpu_seconds) {
  return by_count("contrast, K^2", "frames of two patterns", 128, contrast_point, cpu_seconds);
}

ErrorCurve pictures_by_frames(double cpu_seconds) {
  return by_count("recover, pictures", "the object of the frames", 64, picture_point, cpu_seconds);
}

}  // namespace

std::vector<ErrorRun> imaging_error_runs() {
  return {{"image in space, C_I", "paths", separations_by_paths, true},
          {"contrast, K^2", "frames", contrast_by_frames, false},
          {"recover, pictures", "frames", pictures_by_frames, false},
          {"image, C_I of pairs", "paths", pairs_by_paths, true},
          {"image, patterns of sources", "frames", by_frames, false}};
}

}  // namespace flatspeckle::bench

// Comparisons for imaging: points recovered from autocorrelations, and source patterns.

#include <Eigen/Core>

#include "bench/plan/plan_timing.h"
#include "bench/scenes/blinking_frames.h"
#include "bench/scenes/imaged_points.h"
#include "bench/scenes/speckle_frames.h"
#include "core/numbers/blas.h"
#include "mc/imaging/retrieval/contrast_map.h"

namespace flatspeckle::bench {

namespace {

/// Compares beam searches that keep 8000 and 1000 partial objects.
TwoAlternatives more_objects(bool) {
  constexpr std::size_t kept = 1000, more = 8000;
  const std::vector<double> marks{0, 40, 111, 163, 230, 255, 310};
  const auto found = [marks, peaks = noisy_peaks(marks, 4, 1)](std::size_t beam) {
    const auto fit = mc::sparse_search(peaks, {marks.size(), 1, beam});
    return std::vector<Complex>{fit.object.x.begin(), fit.object.x.end()};
  };
  return {[=] { return found(more); }, [=] { return found(kept); }};
}

/// Compares singular values by LAPACK with those from the matrix of products of frames.
TwoAlternatives products_of_frames(bool) {
  const auto made = blinking_frames({.pixels = 2000}, 1);
  Eigen::MatrixXd light(2000, static_cast<Eigen::Index>(made.frames.size()));
  for (Eigen::Index f = 0; f < light.cols(); ++f)
    light.col(f) = Eigen::Map<const Eigen::VectorXd>(
        made.frames[static_cast<std::size_t>(f)].data(), light.rows());
  const auto complex = [](const auto& values) {
    return std::vector<Complex>(values.begin(), values.end());
  };
  const auto by_lapack = [light] {
    Eigen::MatrixXd left = light;
    const auto rows = static_cast<lapack_int>(left.rows()),
               columns = static_cast<lapack_int>(left.cols());
    Eigen::VectorXd values(columns);
    LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'N', rows, columns, left.data(), rows, values.data(), nullptr,
                   1, nullptr, 1);
    return values;
  };
  return {[=] { return complex(by_lapack()); },
          [=] { return complex(mc::source_count(light, {}).singular_values); }};
}

/// Compares maps of speckle contrast whose windows are summed one by one with those from sums along
/// rows and columns.
TwoAlternatives windows_one_by_one(bool) {
  constexpr std::size_t window = 15;
  const Frames frames = mixed_speckle(1, 192, 2, 1);
  const auto map_of = [=] { return mc::contrast_map(frames, {.window = window}); };
  const auto one_by_one = [=, correlation = map_of().correlation] {
    std::vector<Complex> squares;
    for (std::size_t y = 0; y + window <= frames.rows; ++y)
      for (std::size_t x = 0; x + window <= frames.columns; ++x) {
        double sum = 0, square = 0;
        for (std::size_t i = 0; i < window * window; ++i) {
          const double value = frames.values[(y + i / window) * frames.columns + x + i % window];
          sum += value;
          square += value * value;
        }
        constexpr double pixels = window * window;
        const double mean = sum / pixels,
                     variance = (square / pixels - mean * mean) / (1 - correlation);
        squares.emplace_back(variance / (mean * mean - correlation * variance));
      }
    return squares;
  };
  return {one_by_one, [=] {
            const auto map = map_of();
            return std::vector<Complex>(map.square.begin(), map.square.end());
          }};
}

/// Compares the fields of seven points on a camera, path by path and as products of matrices. Both
/// are intensities, averaged over pixels and fields, because the paths differ.
TwoAlternatives products_of_paths(bool) {
  const mc::PictureScene scene = imaged_in_space();
  const auto mean_of_fields = [scene](const mc::FieldDraw& draw) {
    std::vector<Complex> field(scene.scene.request.channels.size());
    std::vector<double> intensity(field.size());
    double sum = 0;
    for (std::uint64_t number = 0; number < 4; ++number) {
      draw(number, field, intensity);
      for (const Complex u : field) sum += std::norm(u) / static_cast<double>(field.size());
    }
    return std::vector<Complex>{sum};
  };
  constexpr std::uint64_t paths = 4000;
  const mc::Plan plan = mc::make_plan(scene.scene, mc::ReversedPaths::automatic);
  return {[=] { return mean_of_fields(mc::fields_by_paths(scene.scene, plan, 1, paths)); },
          [=] { return mean_of_fields(mc::picture_fields(scene, {}, paths)); }};
}

}  // namespace

std::vector<PlanCase> imaging_plan_cases() {
  constexpr double root_of_rounding = 1e-7;
  return {
      case_of_values(
          {"imaging", "more partial objects", "7 points, peaks 4 times the noise", "search"}, 1e-11,
          more_objects),
      case_of_values(
          {"imaging", "pixels in singular values", "40 frames of 2000 pixels", "decomposition"},
          root_of_rounding, products_of_frames),
      case_of_values({"imaging", "windows one by one", "contrast of 192 x 192 pixels", "map"}, 1e-9,
                     windows_one_by_one),
      case_of_values({"imaging", "sums path by path", "7 points, 64 x 64 pixels", "four fields"},
                     0.2, products_of_paths)};
}

}  // namespace flatspeckle::bench

// Comparisons for imaging: points recovered from autocorrelations, and source patterns.

#include <Eigen/Core>

#include "bench/plan/plan_timing.h"
#include "bench/scenes/blinking_frames.h"
#include "bench/scenes/imaged_points.h"
#include "core/numbers/blas.h"

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

}  // namespace

std::vector<PlanCase> imaging_plan_cases() {
  constexpr double root_of_rounding = 1e-7;
  return {case_of_values(
              {"imaging", "more partial objects", "7 points, peaks 4 times the noise", "search"},
              1e-11, more_objects),
          case_of_values(
              {"imaging", "pixels in singular values", "40 frames of 2000 pixels", "decomposition"},
              root_of_rounding, products_of_frames)};
}

}  // namespace flatspeckle::bench

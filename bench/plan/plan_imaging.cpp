// Points found in autocorrelations.

#include <Eigen/SVD>

#include "bench/plan/plan_rooms.h"
#include "bench/plan/plan_timing.h"
#include "bench/scenes/blinking_frames.h"
#include "bench/scenes/imaged_points.h"

namespace flatspeckle::bench {

namespace {

const std::vector<double> marks{0, 40, 111, 163, 230, 255, 310};

std::vector<Complex> found(const mc::PairPeaks& peaks, std::size_t beam) {
  const auto fit = mc::sparse_search(peaks, {marks.size(), 1, beam});
  return {fit.object.x.begin(), fit.object.x.end()};
}

/// Partial objects beyond a thousand.
PlanRow more_objects(double cpu_seconds) {
  constexpr std::size_t kept = 1000, more = 8000;
  PlanRow row{.per = "search"};
  const mc::PairPeaks peaks = noisy_peaks(marks, 4, 1);
  compare_values(
      row, [&] { return found(peaks, more); }, [&] { return found(peaks, kept); }, 1e-11,
      cpu_seconds);
  return row;
}

/// Singular vectors, and all but the products of frames.
PlanRow products_of_frames(double cpu_seconds) {
  PlanRow row{.per = "decomposition"};
  const auto made = blinking_frames({.pixels = 2000}, 1);
  Eigen::MatrixXd light(2000, static_cast<Eigen::Index>(made.frames.size()));
  for (Eigen::Index f = 0; f < light.cols(); ++f)
    light.col(f) = Eigen::Map<const Eigen::VectorXd>(
        made.frames[static_cast<std::size_t>(f)].data(), light.rows());
  const auto complex = [](const auto& values) {
    return std::vector<Complex>(values.begin(), values.end());
  };
  constexpr double of_products = 1e-7;  // the root of rounding
  compare_values(
      row, [&] { return complex(Eigen::BDCSVD<Eigen::MatrixXd>(light).singularValues()); },
      [&] { return complex(mc::source_count(light, {}).singular_values); }, of_products,
      cpu_seconds);
  return row;
}

}  // namespace

std::vector<PlanCase> imaging_plan_cases() {
  return {
      named("imaging", "more partial objects", "7 points, peaks 4 times the noise", more_objects),
      named("imaging", "pixels in singular values", "40 frames of 2000 pixels",
            products_of_frames)};
}

}  // namespace flatspeckle::bench

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/run/runner.h"
#include "flatland/scene/scene.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// What some thousand paths tell about the fields of a scene, before any is drawn.
struct PathSurvey {
  double contributions = 0;       ///< per path
  std::vector<double> intensity;  ///< E|u|^2 per channel
  /// Variance of the intensity that one path brings, over the square of its mean, per channel: the
  /// relative error of an intensity from P paths is sqrt(spread / P).
  std::vector<double> spread;
  /// E|u|^4 / (E|u|^2)^2 - 2 of the field of one path, per channel. A field of N paths has this / N
  /// (their phases are independent), a Gaussian field 0; its contrast is sqrt(1 + excess / N), and
  /// the intensities of distant speckles have a correlation of up to excess / N.
  std::vector<double> excess;
};

/// Batches for the runner; stop after survey_paths samples.
BatchJob survey_job(const Scene& scene, const Plan& plan, std::uint64_t seed);
inline constexpr std::uint64_t survey_paths = 16384;
PathSurvey read_survey(const GroupedSums& sums);

enum class FieldMethod { automatic, paths, covariance };

/// What is asked for.
struct FieldDemand {
  FieldMethod method = FieldMethod::automatic;
  std::uint64_t fields = 0;
  /// None: so many that the excess is 0.01.
  std::optional<std::uint64_t> paths_per_field = std::nullopt;
  double covariance_error = 0.01;  ///< relative, of the diagonal
};

/// How a scene's fields are drawn.
struct DrawingPlan {
  FieldMethod method = FieldMethod::paths;  ///< never automatic
  std::uint64_t paths_per_field = 0, covariance_paths = 0;
  double excess = 0;  ///< of fields by paths, the magnitude of the largest of all channels
  /// Complex multiply-adds, for all fields. The covariance's is infinite where it does not fit.
  double paths_cost = 0, covariance_cost = 0;

  std::string describe() const;
};

/// The cheaper way that gives what is asked for.
DrawingPlan make_field_plan(const Scene& scene, const PathSurvey& survey,
                            const FieldDemand& demand);

}  // namespace flatspeckle::mc

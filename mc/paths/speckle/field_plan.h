#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/run/runner.h"
#include "flatland/scene/scene.h"
#include "mc/paths/speckle/camera_sides.h"
#include "mc/paths/speckle/field_changes.h"
#include "mc/paths/speckle/lens_image.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Results of the pilot run (the survey): statistics of the light paths of a scene, estimated from
/// survey_paths paths before any field is drawn.
struct PathSurvey {
  double contributions = 0;       ///< mean number of scored contributions per path
  std::vector<double> intensity;  ///< E|u|^2 per channel
  /// Variance of the intensity of one path over the square of its mean, per channel. The relative
  /// error of an intensity from P paths is sqrt(spread / P).
  std::vector<double> spread;
  /// Excess kurtosis E|u|^4 / (E|u|^2)^2 - 2 of the field of one path, per channel; for a Gaussian
  /// field it would be 0. The phases of paths are independent, so a field of N paths has an excess
  /// kurtosis of excess / N. Its contrast is sqrt(1 + excess / N), and the intensities of distant
  /// speckles have a correlation of up to excess / N.
  std::vector<double> excess;
};

/// Makes the job of the pilot run (the survey), which is run for survey_paths samples. image: if
/// set, the channels are a few pixels of the image of this plane, and the camera of the scene is
/// the pupil.
BatchJob survey_job(const Scene& scene, const Plan& plan, std::uint64_t seed,
                    const std::optional<LensPlane>& image = {});
inline constexpr std::uint64_t survey_paths = 16384, image_survey_paths = 4096;
PathSurvey read_survey(const GroupedSums& sums);

enum class FieldMethod { automatic, paths, covariance };

/// Requested number of fields, and how to draw them.
struct FieldDemand {
  FieldMethod method = FieldMethod::automatic;
  std::uint64_t fields = 0;
  /// Number of light paths per field. If it is not set, the number is chosen for an excess kurtosis
  /// of 0.01 of the fields.
  std::optional<std::uint64_t> paths_per_field = std::nullopt;
  double covariance_error = 0.01;  ///< relative error of the diagonal of the covariance
  double camera_tolerance = 0.01;  ///< largest relative rms error of a CameraSum
  FieldChanges changes{};          ///< fields of each realization
  /// Plane of which a lens makes an image; the camera of the scene is then its pupil (pupil_of())
  std::optional<LensPlane> image{};

  /// Whether fields can only be drawn from paths.
  bool requires_paths() const { return !changes.none() || image; }
};

/// Plan for drawing the fields of a scene.
struct DrawingPlan {
  FieldMethod method = FieldMethod::paths;  ///< paths or covariance, never automatic
  std::uint64_t paths_per_field = 0, covariance_paths = 0;
  /// Excess kurtosis of fields drawn from paths: its largest magnitude over all channels
  double excess = 0;
  /// Costs of drawing all fields from paths and from the covariance, in complex multiply-adds.
  /// covariance_cost is infinite if the covariance does not fit into memory.
  double paths_cost = 0, covariance_cost = 0;
  std::optional<CameraResolution> camera{};  ///< set if paths are summed on a camera
  /// Whether the intensity is the mean of |u|^2 over the fields themselves.
  bool has_own_mean = false;

  std::string describe() const;
};

/// Returns the plan of the paths of fields. is_image: whether a lens forms an image of them.
/// Walkers of equal weight in a wide lossless box light few of its resolution cells strongly, so
/// that its paths are weighted.
Plan plan_of_fields(const Scene& scene, ReversedPaths reversed, bool is_image);

/// Plans the drawing of the requested fields, by the cheaper method if the method is automatic.
DrawingPlan make_field_plan(const Scene& scene, const PathSurvey& survey,
                            const FieldDemand& demand);

}  // namespace flatspeckle::mc

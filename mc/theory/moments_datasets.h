#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

/// Meaning of the attribute `censored` of a range.
inline constexpr const char* censored_meaning =
    "0: interpolated; 1: the curve does not fall to one half, the value is the last step; 2: the "
    "curve is below one half at the first step, which is the value";

extern const DatasetTable mean_table, intensity_table, pairs_table, full_table, moves_table;

/// Returns the table of the datasets that a result file contains for a kind of request: the
/// covariance, and its derivatives (gradient_job.h).
const DatasetTable& request_table(CovarianceRequest::Kind kind);

/// Expands the lower triangle of a full request's entries to the whole matrix.
Estimate unpack_full(const CovarianceRequest& request, const Estimate& triangle);

/// A range as written to a file, in the unit of its dataset.
struct WrittenRange {
  std::string long_name;
  RangeEstimate estimate;
  bool few_steps = false;
  bool is_angle = false;  ///< whether the unit is rad
};

/// Values written for a group of views (view_groups()): the field correlation C_E of each move
/// (tilt, shift or translation), and the ranges.
struct WrittenMoves {
  Estimate correlation;
  std::vector<WrittenRange> ranges;
};

/// Writes the mean field and the covariance, each with its standard error, into a group of the file
/// (empty: the root). For requests with moves it also writes correlations and ranges for each of
/// the view_groups(), and theory for the first group; it returns one element for each group. For
/// other requests it returns none. moments: the estimates of the job from the sums. The axes must
/// have been written before (flatland/scene/scene_datasets.h).
std::vector<WrittenMoves> write_moments(ResultFile& file, const std::string& group,
                                        const FieldJob& job, const Scene& scene,
                                        const GroupedSums& sums, const FieldMoments& moments);

}  // namespace flatspeckle::mc

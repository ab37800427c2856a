#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

/// Of a range's attribute.
inline constexpr const char* censored_meaning =
    "0: read off the curve; 1: the curve does not fall so far, the value is the last step's; 2: it "
    "has fallen before the first step, the value is that step's";

extern const DatasetTable mean_table, intensity_table, pairs_table, full_table, moves_table;

/// That of a request's covariance, with the derivatives of gradient.h too.
const DatasetTable& request_table(CovarianceRequest::Kind kind);

/// The lower triangle of a full request's entries as the whole matrix.
Estimate unpack_full(const CovarianceRequest& request, const Estimate& triangle);

/// A range as a file has it, in the unit of its row.
struct WrittenRange {
  std::string long_name;
  RangeEstimate estimate;
  bool few_steps = false;
};

/// What a file has of moves of a group of views: C_E of each, and ranges.
struct WrittenMoves {
  Estimate correlation;
  std::vector<WrittenRange> ranges;
};

/// Writes mean field and covariance, each with its standard error, into a group (empty: the root),
/// and for moves what follows, of each of its view_groups(): correlations, their ranges,
/// theory of the first. Axes must have been written (flatland/scene/scene_datasets.h); moments are
/// those of job and sums. Returns one per group, none for other requests.
std::vector<WrittenMoves> write_moments(ResultFile& file, const std::string& group,
                                        const FieldJob& job, const Scene& scene,
                                        const GroupedSums& sums, const FieldMoments& moments);

}  // namespace flatspeckle::mc

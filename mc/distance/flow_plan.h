#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/distance/distance_job.h"
#include "mc/distance/instrument.h"

namespace flatspeckle::mc {

/// Noise of an instrument, and the signal-to-noise ratio of the flow: the flow of the chosen layers
/// divided by the standard error of its estimate. Crosstalk is the relative change of the same
/// estimate for a relative change of 1 of the flow of all other layers.
struct FlowPlan {
  std::vector<double> rate;                                      ///< photons per second, [distance]
  std::vector<double> photons, bias, deviation;                  ///< of K^2, [exposure][distance]
  std::vector<double> contrast_ratio, contrast_crosstalk;        ///< [exposure][distance]
  std::vector<double> contrast_separated;                        ///< [exposure]
  std::vector<double> correlation_deviation;                     ///< of g2, [delay][distance]
  std::vector<double> correlation_ratio, correlation_crosstalk;  ///< [distance]
  double correlation_separated = 0;
};

/// Propagates the noise of K^2 and of g2 to the flow, by least squares weighted by variances. The
/// separated ratios are those of all distances together, with the flow of the other layers unknown.
/// found: estimates of the request, with derivatives.
FlowPlan flow_plan(const Instrument& instrument, const DistanceRequest& request,
                   const DistanceEstimates& found);

extern const DatasetTable flow_table;
/// Writes the plan into a file that contains the results of write_distance().
void write_flow(ResultFile& file, const Instrument& instrument, const DistanceRequest& request,
                const FlowPlan& plan);

}  // namespace flatspeckle::mc

#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/invariant.h"
#include "core/result/result_file.h"
#include "core/run/runner.h"
#include "flatland/media/domain.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/light_aperture.h"

namespace flatspeckle::mc {

/// Positions of the power shares in the sums of one illumination in a FluxJob. The bins of the exit
/// angle follow them.
enum FluxShare : std::size_t { reflected, transmitted, through_sides, absorbed, flux_shares };

/// Job that computes where the power of each illumination goes, without phases. Shares are
/// fractions of the power that is incident on the medium.
struct FluxJob {
  BatchJob batches;  ///< a sample is one light path of each illumination
  std::size_t lights = 0, angle_bins = 0;
  std::string plan;
  double angles = 2 * std::numbers::pi;  ///< range of exit angles that the bins cover, in radians
};

/// Fractions of each illumination that are scattered out through the face z = 0, the face z = depth
/// and the sides of a box, or absorbed. With unscattered_shares() these shares add up to 1.
struct FluxEstimates {
  Estimate reflectance, transmittance, side_loss, absorptance;
  /// Share per radian of the exit angle (in 3D: of the polar angle), [light][angle bin]
  Estimate exit_radiance;
};
FluxEstimates flux_estimates(const FluxJob& job, const GroupedSums& sums);

/// Returns, for each illumination, the deviation from 1 of the sum of its shares and its
/// unscattered share (`direct`). The shares are estimated independently, so an error in one of them
/// changes the sum. The limit of the deviation is the sum of the errors of the shares for a
/// deterministic solution, and outlier_errors() standard errors for samples.
std::vector<Invariant> power_balance(const FluxJob& job, const GroupedSums& sums,
                                     const std::vector<double>& direct);

extern const DatasetTable flux_table;
/// Writes the estimates and their axes, the illuminations and the exit angles.
void write_flux(ResultFile& file, const Scene& scene, const FluxEstimates& flux);

/// Returns the fraction of an illumination that crosses the medium neither scattered nor absorbed
/// (ballistic light). This fraction has a closed form unless the medium varies; for boxes in space
/// it is a sum over 65,536 rays, with an error of about 1e-5.
double direct_transmittance(const Scene& scene, const Light& light);
inline double direct_transmittance(const Scene& scene, double angle) {
  return direct_transmittance(scene, plane_wave(angle));
}
/// Returns the fraction of an illumination that faces reflect and that is neither scattered nor
/// absorbed; 0 without faces. angle: that of the illumination.
double specular_reflectance(const Scene& scene, double angle);
/// Returns, for each illumination, the sum of its direct transmittance and specular reflectance.
std::vector<double> unscattered_shares(const Scene& scene);

}  // namespace flatspeckle::mc

#pragma once

#include <optional>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/invariant.h"
#include "core/result/result_file.h"
#include "core/run/runner.h"
#include "flatland/scene/scene.h"
#include "mc/distance/hankel_contour.h"
#include "mc/jobs/contrast.h"
#include "mc/jobs/dynamics.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// A request for the light that a beam along the normal leads to detectors on the surface z = 0 of
/// a slab in space.
struct DistanceRequest {
  std::vector<DistanceDetector> detectors;
  double source_radius = 0;
  double numerical_aperture = 1;  ///< of the detectors, outside the medium
  Dynamics dynamics{};            ///< delays of the field correlation; may be empty
  bool gradient = false;          ///< whether derivatives by the coefficients of layers are wanted
  std::optional<double> length_unit{};  ///< metres per unit of length, if known
};

/// Coefficients of a layer by which derivatives are computed. diffusion: the factor of the layer on
/// the diffusion constant.
enum class LayerCoefficient { mu_a, mu_s, diffusion };
inline constexpr int layer_coefficients = 3;

/// Indices of the values of distance_solution().
struct DistanceLayout {
  std::size_t detectors, delays, parts;

  DistanceLayout(const DistanceRequest& request, std::size_t values)
      : detectors(request.detectors.size()),
        delays(request.dynamics.delays.size() + 1),
        parts(values / (detectors * delays)) {}
  /// delay: 0, or one more than the index of a delay of the request. part: 0, or that of a
  /// derivative.
  std::size_t operator()(std::size_t part, std::size_t delay, std::size_t detector) const {
    return (part * delays + delay) * detectors + detector;
  }
};

/// Solves for the field correlation on the detectors by expansion in spherical harmonics at each
/// transverse frequency. values: [delay][detector], the first delay being 0; then, with
/// derivatives, [layer][coefficient][delay][detector]. They are fractions of the incident power.
/// The degree of the harmonics is increased until two successive solutions agree.
Refined distance_solution(const Scene& slab, const DistanceRequest& request, double tolerance);

/// Returns the values of distance_solution() for harmonics up to one fixed degree: a smooth
/// function of the medium.
std::vector<Complex> distance_values(const Scene& slab, const DistanceRequest& request, int degree);

/// Returns distance_solution() as a job (two_batches()).
BatchJob distance_job(const Scene& slab, const DistanceRequest& request, double tolerance);

/// Estimates from distance_job().
struct DistanceEstimates {
  Estimate power;        ///< [detector]
  Estimate reflectance;  ///< power per area, [detector]
  Estimate correlation;  ///< g1, [delay][detector]
  Estimate intensity;    ///< g2 - 1 = beta g1^2, [delay][detector]
  Estimate contrast;     ///< K^2, [exposure time][detector]
  /// Derivatives of the power and of g1 by the coefficients, [layer][coefficient][detector] and
  /// [layer][coefficient][delay][detector].
  Estimate power_gradient, correlation_gradient;
  Estimate layer_path;  ///< mean path of the detected light in a layer: [layer][detector]
};
DistanceEstimates distance_estimates(const DistanceRequest& request, const GroupedSums& sums);

/// Returns, for each detector, the relative difference of its power from that by the radiance at
/// the surface, instead of that by the adjoint radiance (LayeredRadiance): they agree by
/// reciprocity. tolerance: limit of the difference.
std::vector<Invariant> reciprocity(const Scene& slab, const DistanceRequest& request,
                                   double tolerance);

extern const DatasetTable distance_table;
void write_distance(ResultFile& file, const DistanceRequest& request,
                    const DistanceEstimates& found);

}  // namespace flatspeckle::mc

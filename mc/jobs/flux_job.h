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

namespace flatspeckle::mc {

/// The part of a domain's outline through which a plane wave along `light` enters: a face and, for
/// a box, a side.
class LightAperture {
 public:
  LightAperture(const Domain& domain, Vec2 light)
      : domain_(domain),
        light_(light),
        is_slab_(domain.kind == Domain::Kind::slab),
        face_(is_slab_ ? std::abs(light.z) : domain.width * std::abs(light.z)),
        side_(is_slab_ ? 0 : domain.depth * std::abs(light.x)) {}

  // Projected widths of the face and the side, perpendicular to the light; for a slab, per unit
  // length of the face.
  double face() const { return face_; }
  double side() const { return side_; }

  /// Returns the entry point at a fraction `share` of the projected width of face and side, in this
  /// order. In a slab one point represents all.
  Vec2 at(double share) const {
    const double z = light_.z > 0 ? 0 : domain_.depth;
    if (is_slab_) return {0, z};
    const double across = share * (face_ + side_);
    if (across < face_) return {across / std::abs(light_.z) - domain_.width / 2, z};
    return {std::copysign(domain_.width / 2, -light_.x), (across - face_) / std::abs(light_.x)};
  }

 private:
  Domain domain_;
  Vec2 light_;
  bool is_slab_;
  double face_, side_;
};

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
/// (ballistic light). This fraction has a closed form unless the medium varies. light: angle of the
/// illumination.
double direct_transmittance(const Scene& scene, double light);
/// Returns the fraction of an illumination that faces reflect and that is neither scattered nor
/// absorbed; 0 without faces.
double specular_reflectance(const Scene& scene, double light);
/// Returns, for each illumination, the sum of its direct transmittance and specular reflectance.
std::vector<double> unscattered_shares(const Scene& scene);

}  // namespace flatspeckle::mc

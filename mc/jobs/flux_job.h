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

/// The part of a domain's outline that a plane wave along `light` enters through: a face and, of a
/// box, a side.
class LightAperture {
 public:
  LightAperture(const Domain& domain, Vec2 light)
      : domain_(domain),
        light_(light),
        is_slab_(domain.kind == Domain::Kind::slab),
        face_(is_slab_ ? std::abs(light.z) : domain.width * std::abs(light.z)),
        side_(is_slab_ ? 0 : domain.depth * std::abs(light.x)) {}

  // Widths across the light; of a slab per unit length.
  double face() const { return face_; }
  double side() const { return side_; }

  /// The point at a share of the way across; of a slab one stands for all.
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

/// The sums of one light in a FluxJob: these shares, then the bins of the exit angle.
enum FluxShare : std::size_t { reflected, transmitted, through_sides, absorbed, flux_shares };

/// The classical smooth Monte Carlo: intensity without phases. Shares are of the power of a light
/// that meets the medium.
struct FluxJob {
  BatchJob batches;  ///< samples: light paths of each light
  std::size_t lights = 0, angle_bins = 0;
  std::string plan;
  double angles = 2 * std::numbers::pi;  ///< that the bins cover
};

/// Scattered light per light: its shares that leave through the face z = 0, the face z = depth and
/// the sides of a box, and what is absorbed. With the direct transmittance they add up to 1.
struct FluxEstimates {
  Estimate reflectance, transmittance, side_loss, absorptance;
  Estimate exit_radiance;  ///< [light][angle bin]: share per radian of exit angle, in space polar
};
FluxEstimates flux_estimates(const FluxJob& job, const GroupedSums& sums);

/// How far the shares of each light, with what is not scattered (direct), are from adding up to 1.
/// None of them follows from the others, so that a wrong one shows. Limits are the errors of
/// solutions, and Student's quantile of samples (outlier_errors).
std::vector<Invariant> power_balance(const FluxJob& job, const GroupedSums& sums,
                                     const std::vector<double>& direct);

extern const DatasetTable flux_table;
/// With the axes of lights and exit directions.
void write_flux(ResultFile& file, const Scene& scene, const FluxEstimates& flux);

/// Share of a light that crosses the medium unscattered and not absorbed (ballistic), in closed
/// form.
double direct_transmittance(const Scene& scene, double light);
std::vector<double> direct_transmittances(const Scene& scene);

}  // namespace flatspeckle::mc

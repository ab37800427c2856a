#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grin/media/index/sample_grid.h"
#include "grin/media/scattering/space_phases.h"

namespace flatspeckle::grin {

/// A relative density on a grid, trilinear between the nodes, 0 outside the grid.
class DensityGrid {
 public:
  /// Throws InputError for fewer than 2 nodes along an axis, a spacing <= 0, another number of
  /// values than nodes, or a value that is negative or not finite.
  DensityGrid(const FieldGrid& grid, std::span<const double> density);

  double operator()(const Vec3& x) const;
  double largest() const { return largest_; }
  const FieldGrid& grid() const { return grid_; }

 private:
  FieldGrid grid_;
  Vec3 per_spacing_;
  std::vector<double> density_;
  double largest_ = 0;
};

/// Dataset "density" (read_samples).
DensityGrid read_density_grid(const std::filesystem::path& path);

/// What scatters and absorbs, 1/length.
struct ScatteringMedium {
  double mu_s = 0, mu_a = 0;  ///< where the relative density is 1
  SpacePhaseFunction phase = {};
  std::shared_ptr<const DensityGrid> density = {};  ///< relative; nothing: 1 everywhere

  double mu_t() const { return mu_s + mu_a; }
  double albedo() const { return mu_s > 0 ? mu_s / mu_t() : 0; }
  double absorption(const Vec3& x) const { return density ? mu_a * (*density)(x) : mu_a; }
};

/// A medium as keys have it; without mu_s and mu_a there is none.
struct MediumValues {
  std::optional<double> mu_s = {}, mu_a = {};
  std::string phase = IsotropicPhase::word, density = {};
  SpacePhaseKinds kinds{};

  template <class Kind>
  Kind& of() {
    return std::get<Kind>(kinds);
  }
};

/// prefix: of the keys, "" or "body_".
void add_keys(Keys& keys, MediumValues& values, const std::string& prefix);

/// Throws InputError.
ScatteringMedium make_medium(const Keys& keys, const MediumValues& values);

}  // namespace flatspeckle::grin

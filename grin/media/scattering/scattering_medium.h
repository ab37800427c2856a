#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grin/media/index/sample_grid.h"
#include "grin/media/scattering/space_phases.h"

namespace flatspeckle::grin {

/// Relative density of a medium, given on a grid. It is interpolated trilinearly between the nodes
/// and is 0 outside the grid.
class DensityGrid {
 public:
  /// Throws InputError for fewer than 2 nodes along an axis, a spacing <= 0, a number of values
  /// other than the number of nodes, or a value that is negative or not finite.
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

/// Reads the dataset "density" of a file, with read_samples().
DensityGrid read_density_grid(const std::filesystem::path& path);

class LabelledMedia;

/// A scattering and absorbing medium; coefficients in 1/length. A medium of labelled voxels has the
/// mean coefficients of its voxels.
struct ScatteringMedium {
  /// Scattering and absorption coefficients where the relative density is 1.
  double mu_s = 0, mu_a = 0;
  SpacePhaseFunction phase = {};
  std::shared_ptr<const DensityGrid> density = {};   ///< relative density; null: 1 everywhere
  std::shared_ptr<const LabelledMedia> labels = {};  ///< media of labelled voxels, or null

  bool is_uniform() const { return !density && !labels; }
  double mu_t() const { return mu_s + mu_a; }
  double albedo() const { return mu_s > 0 ? mu_s / mu_t() : 0; }
  /// Returns the medium at x: that of a label, or this one.
  const ScatteringMedium& at(const Vec3& x) const { return labels ? in_voxel(x) : *this; }
  double absorption(const Vec3& x) const { return density ? mu_a * (*density)(x) : at(x).mu_a; }
  /// Returns the extinction at x relative to mu_t(), and its largest value.
  double relative(const Vec3& x) const { return density ? (*density)(x) : at(x).mu_t() / mu_t(); }
  double largest_relative() const;

 private:
  const ScatteringMedium& in_voxel(const Vec3& x) const;
};

/// Scene keys of a medium. If neither mu_s, mu_a nor labels is given, there is no medium.
struct MediumValues {
  std::optional<double> mu_s = {}, mu_a = {};
  std::string phase = IsotropicPhase::word, density = {}, labels = {};
  std::vector<double> label_media = {};
  SpacePhaseKinds kinds{};

  template <class Kind>
  Kind& of() {
    return std::get<Kind>(kinds);
  }
};

/// Adds the scene keys of a medium. Their names begin with `prefix`, which is "" or "body_".
void add_keys(Keys& keys, MediumValues& values, const std::string& prefix);

/// Makes the medium from its scene keys. Throws InputError for invalid values.
ScatteringMedium make_medium(const Keys& keys, const MediumValues& values);

}  // namespace flatspeckle::grin

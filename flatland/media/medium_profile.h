#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "flatland/media/domain.h"
#include "flatland/media/medium.h"

namespace flatspeckle {

class ResultFile;

/// Motion of the scatterers of one material, for fields at two times: factors on k^2 D and v of
/// the scene. If layers differ in index, k is that in vacuum, and the squared index is a part of the
/// factor.
struct MaterialMotion {
  double diffusion = 1, velocity = 1;
};

/// Material of a part of a medium: its scatterers, their bulk properties and their motion.
struct Material {
  Scatterer scatterer;
  BulkMedium medium;
  MaterialMotion motion{};
  double index = 1;  ///< refractive index around the scatterers
};

/// A medium that varies within a domain. It defines the material at each point, and the density
/// there relative to the density in the material's bulk properties. Points outside the domain have
/// the values at the nearest edge.
class MediumProfile {
 public:
  explicit MediumProfile(std::vector<Material> materials) : materials_(std::move(materials)) {}
  virtual ~MediumProfile() = default;

  const std::vector<Material>& materials() const { return materials_; }
  virtual std::size_t material_at(Vec x) const = 0;
  virtual double relative_density(Vec x) const = 0;

  double mu_t(Vec x) const { return relative_density(x) * bulk(x).mu_t; }
  double mu_s(Vec x) const { return relative_density(x) * bulk(x).mu_s; }
  double albedo(Vec x) const { return bulk(x).albedo; }
  /// Returns the number of scatterers per area or, in space, per volume.
  double density(Vec x) const { return relative_density(x) * bulk(x).density; }
  /// Returns an upper bound of density().
  virtual double most_density() const = 0;

  /// Returns the integral of mu_t over a straight path of the given length from x along w. The path
  /// must lie in the domain.
  virtual double optical_depth(Vec x, Vec w, double length) const = 0;
  /// Returns the distance from x along w after which the path has the given optical depth; at most
  /// `longest`.
  virtual double reach(Vec x, Vec w, double optical_depth, double longest) const = 0;

  /// Returns the same profile with other materials, one for each of materials().
  virtual std::shared_ptr<const MediumProfile> with(std::vector<Material> materials) const = 0;

  /// Returns the average over the whole domain: means of mu_t, mu_s, absorption, density and
  /// k_shift, and the mean of g weighted by mu_s. The result has no T-matrix.
  virtual BulkMedium mean() const = 0;

  /// Writes the profile to a result file.
  virtual void write(ResultFile& file) const = 0;
  /// Returns a short description, printed in the plan of a run.
  virtual std::string describe() const = 0;

 private:
  const BulkMedium& bulk(Vec x) const { return materials_[material_at(x)].medium; }

  std::vector<Material> materials_;
};

}  // namespace flatspeckle

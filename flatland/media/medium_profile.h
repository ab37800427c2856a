#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "flatland/media/domain.h"
#include "flatland/media/medium.h"

namespace flatspeckle {

class ResultFile;

/// Shares of the motion that a scene states (delays).
struct MaterialMotion {
  double diffusion = 1, velocity = 1;
};

/// What a part of a medium is made of.
struct Material {
  Scatterer scatterer;
  BulkMedium medium;
  MaterialMotion motion{};
};

/// A medium that varies from place to place within a domain: which material is where, and how dense
/// over the density of the material's own bulk. Points outside of the domain are as its nearest
/// edge.
class MediumProfile {
 public:
  explicit MediumProfile(std::vector<Material> materials) : materials_(std::move(materials)) {}
  virtual ~MediumProfile() = default;

  const std::vector<Material>& materials() const { return materials_; }
  virtual std::size_t material_at(Vec2 x) const = 0;
  virtual double relative_density(Vec2 x) const = 0;

  double mu_t(Vec2 x) const { return relative_density(x) * bulk(x).mu_t; }
  double mu_s(Vec2 x) const { return relative_density(x) * bulk(x).mu_s; }
  double albedo(Vec2 x) const { return bulk(x).albedo; }
  /// Scatterers per area.
  double density(Vec2 x) const { return relative_density(x) * bulk(x).density; }
  /// No density() is larger.
  virtual double most_density() const = 0;

  /// int mu_t along w, which stays in the domain.
  virtual double optical_depth(Vec2 x, Vec2 w, double length) const = 0;
  /// How far along w an optical depth reaches; at most `longest`.
  virtual double reach(Vec2 x, Vec2 w, double optical_depth, double longest) const = 0;

  /// Of the whole domain: mu_t, mu_s, absorption, density and k_shift in the mean, and g of all
  /// that is scattered. Without a T-matrix.
  virtual BulkMedium mean() const = 0;

  /// What a result file says of it.
  virtual void write(ResultFile& file) const = 0;
  /// In words, for plans.
  virtual std::string describe() const = 0;

 private:
  const BulkMedium& bulk(Vec2 x) const { return materials_[material_at(x)].medium; }

  std::vector<Material> materials_;
};

}  // namespace flatspeckle

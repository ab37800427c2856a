#include "flatland/scene/scene_density.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

namespace {

/// A key that states how dense the scatterers are, other than `count`.
struct DensityKey {
  const char* name;
  std::optional<double> SceneSpec::*member;
};
constexpr DensityKey density_keys[] = {{"density", &SceneSpec::density},
                                       {"mean_free_path", &SceneSpec::mean_free_path},
                                       {"optical_depth", &SceneSpec::optical_depth},
                                       {"volume_fraction", &SceneSpec::volume_fraction},
                                       {"mass_fraction", &SceneSpec::mass_fraction},
                                       {"mu_s", &SceneSpec::mu_s}};

/// Returns the fraction of the volume that the scatterers fill, in the plane of the area, if a key
/// gives it.
std::optional<double> stated_fraction(const SceneSpec& spec) {
  if (spec.volume_fraction) return spec.volume_fraction;
  if (!spec.mass_fraction) return std::nullopt;
  const double particles = *spec.mass_fraction / *spec.particle_density,
               medium = (1 - *spec.mass_fraction) / *spec.medium_density;
  return particles / (particles + medium);
}

}  // namespace

std::vector<std::string> given_densities(const SceneSpec& spec) {
  std::vector<std::string> given;
  if (spec.count) given.emplace_back("count");
  for (const auto& [name, member] : density_keys)
    if (spec.*member) given.emplace_back(name);
  return given;
}

void remove_densities(SceneSpec& spec) {
  spec.count.reset();
  for (const DensityKey& key : density_keys) (spec.*key.member).reset();
  spec.particle_density = spec.medium_density = std::nullopt;
}

void check_density_keys(const Keys& keys, const SceneSpec& spec, const Scatterer& scatterer) {
  keys.read(spec.count);
  for (const DensityKey& key : density_keys) keys.read(spec.*key.member);
  const auto given = given_densities(spec);
  if (given.size() != 1)
    throw InputError(
        (given.empty() ? "no density is given"
                       : "the density is given more than once (" + join_texts(given, ", ") + ")") +
        ": give exactly one of count, density, volume_fraction, mass_fraction, "
        "mean_free_path, optical_depth, mu_s");
  if (spec.mu_s && !(scatterer.is_bulk() && scatterer.kind != Scatterer::Kind::mie))
    throw InputError("mu_s", *spec.mu_s, "requires a phase function, such as scatterer = hg");
  for (const auto* fraction : {&spec.volume_fraction, &spec.mass_fraction})
    if (*fraction && !(scatterer.radius > 0))
      throw InputError(keys.name(*fraction), **fraction,
                       "is a key of soft, hard, tm, te and mie only, which have a size");
  if (!spec.mass_fraction) return;
  keys.required(spec.particle_density);
  keys.required(spec.medium_density);
}

std::optional<double> stated_extinction(const SceneSpec& spec, const Domain& domain) {
  if (spec.mu_s) return *spec.mu_s + spec.mu_a.value_or(0);
  if (spec.mean_free_path) return 1 / *spec.mean_free_path;
  if (spec.optical_depth) return *spec.optical_depth / domain.depth;
  return std::nullopt;
}

std::optional<double> stated_density(const SceneSpec& spec, const Domain& domain,
                                     const Scatterer& scatterer) {
  if (spec.density) return spec.density;
  if (const auto fraction = stated_fraction(spec)) {
    const double density = *fraction / scatterer.content(static_cast<int>(spec.dimension));
    if (!std::isfinite(density))
      throw InputError("radius", scatterer.radius, "is so small that the density is not finite");
    return density;
  }
  if (spec.count && domain.kind == Domain::Kind::box)
    return static_cast<double>(*spec.count) / domain.content();
  return std::nullopt;
}

double number_density(const SceneSpec& spec, const Domain& domain, const Scatterer& scatterer,
                      double sigma_e) {
  if (const auto density = stated_density(spec, domain, scatterer)) return *density;
  if (sigma_e <= 0)
    throw InputError("scatterer", spec.scatterer,
                     "does not scatter, so no density gives this extinction");
  return *stated_extinction(spec, domain) / sigma_e;
}

void check_spheres(const BulkMedium& medium) {
  const double closest = std::numbers::pi / std::sqrt(18.0);
  if (medium.packing_fraction > closest)
    throw InputError("volume fraction", medium.packing_fraction,
                     "must be at most 0.74, the closest packing of spheres; lower the density or "
                     "the radius");
}

}  // namespace flatspeckle

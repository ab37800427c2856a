#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flatland/scene/scene.h"

namespace flatspeckle {

// Number density and extinction of a scene without layers, from the keys that state them.

/// Returns the names of the given keys of the scene that set the density of the scatterers.
std::vector<std::string> given_densities(const SceneSpec& spec);
/// Removes all values that set the density of the scatterers.
void remove_densities(SceneSpec& spec);
/// Throws InputError unless exactly one key gives the density, and the scatterer has a size if it
/// is a fraction of volume or mass.
void check_density_keys(const Keys& keys, const SceneSpec& spec, const Scatterer& scatterer);

/// Returns mu_t if mean_free_path, optical_depth or mu_s is given, otherwise nullopt.
std::optional<double> stated_extinction(const SceneSpec& spec, const Domain& domain);
/// Returns the number of scatterers per area (in space per volume) if keys determine it without the
/// extinction of a scatterer, otherwise nullopt. A mass fraction w is converted to the volume
/// fraction (w / rho_p) / (w / rho_p + (1 - w) / rho_m), with rho_p and rho_m the masses per volume
/// of the scatterers and of the medium around them.
std::optional<double> stated_density(const SceneSpec& spec, const Domain& domain,
                                     const Scatterer& scatterer);
/// Returns the number of scatterers per area. sigma_e: extinction cross section of a scatterer.
/// Throws InputError if it is 0 and the extinction of the medium is given.
double number_density(const SceneSpec& spec, const Domain& domain, const Scatterer& scatterer,
                      double sigma_e);

/// Throws InputError if spheres of the stated density fill more than the closest packing.
void check_spheres(const BulkMedium& medium);

}  // namespace flatspeckle

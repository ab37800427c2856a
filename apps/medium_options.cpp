#include "apps/medium_options.h"

#include <cmath>
#include <filesystem>

#include "core/error.h"
#include "grin/media/field_file.h"

namespace flatspeckle::apps {

namespace {

using Kind = grin::SpacePhaseFunction::Kind;

double coefficient(const std::string& key, double value) {
  if (!(std::isfinite(value) && value >= 0)) throw InputError(key, value, "must not be negative");
  return value;
}

Kind kind_of(const std::string& key, const std::string& name) {
  if (name == "isotropic") return Kind::isotropic;
  if (name == "henyey_greenstein") return Kind::henyey_greenstein;
  if (name == "rayleigh") return Kind::rayleigh;
  throw InputError(key, name, "must be one of henyey_greenstein isotropic rayleigh");
}

std::shared_ptr<const grin::DensityGrid> read_density(const std::string& key,
                                                      const std::string& path) {
  if (!std::filesystem::exists(path)) throw InputError(key, path, "no such file");
  try {
    return std::make_shared<grin::DensityGrid>(grin::read_density_grid(path));
  } catch (const InputError& error) {
    throw InputError(key + ": " + error.what());  // names the file
  }
}

}  // namespace

void add_space_medium_options(Options& options, MediumSpec& spec, const std::string& prefix,
                              const std::string& of) {
  const std::string key = "--" + prefix;
  options.add(key + "mu_s", spec.mu_s,
              "Scattering coefficient of " + of + ", 1/length (default 0)");
  options.add(key + "mu_a", spec.mu_a, "Absorption coefficient, 1/length (default 0)");
  options.add(key + "phase", spec.phase,
              "Phase function: isotropic (default), henyey_greenstein or rayleigh");
  options.add(key + "g", spec.g, "Mean cosine of henyey_greenstein, |g| < 1");
  options.add(key + "density", spec.density,
              "HDF5 with density[x, y, z], by which both coefficients are multiplied, and its "
              "attributes origin, spacing; 0 outside the grid");
}

grin::ScatteringMedium make_space_medium(const Subcommand& command, const MediumSpec& spec,
                                         const std::string& prefix) {
  grin::ScatteringMedium medium;
  medium.mu_s = coefficient(prefix + "mu_s", spec.mu_s);
  medium.mu_a = coefficient(prefix + "mu_a", spec.mu_a);
  medium.phase.kind = kind_of(prefix + "phase", spec.phase);
  medium.phase.g = spec.g;
  if (!(std::abs(spec.g) < 1)) throw InputError(prefix + "g", spec.g, "must be between -1 and 1");
  if (command.given(prefix + "g") && medium.phase.kind != Kind::henyey_greenstein)
    throw InputError(prefix + "g: " + prefix + "phase (" + spec.phase + ") has no use for it");
  for (const std::string key : {"phase", "g", "density"})
    if (command.given(prefix + key) && !command.given(prefix + "mu_s") &&
        !command.given(prefix + "mu_a"))
      throw InputError(prefix + key + ": without " + prefix + "mu_s there is no use for it");
  if (!spec.density.empty()) medium.density = read_density(prefix + "density", spec.density);
  return medium;
}

std::string first_medium_key(const Subcommand& command, const std::string& prefix) {
  for (const char* key : {"mu_s", "mu_a", "phase", "g", "density"})
    if (command.given(prefix + key)) return prefix + key;
  return "";
}

}  // namespace flatspeckle::apps

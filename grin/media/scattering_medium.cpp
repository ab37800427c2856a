#include "grin/media/scattering_medium.h"

#include <algorithm>
#include <cmath>

#include "grin/media/start_directions.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

/// The integral of 3/8 (1 + c^2) from -1 is u where c^3 + 3 c = 8 u - 4; Cardano.
double rayleigh_cosine(double u) {
  const double half = 4 * u - 2;
  const double root = std::cbrt(half + std::sqrt(half * half + 1));
  return root - 1 / root;
}

/// The words of the kinds, in their order.
std::vector<std::string> words() {
  return {"isotropic", "henyey_greenstein", "rayleigh"};
}

SpacePhaseFunction::Kind kind_of(const std::string& word) {
  const auto all = words();
  return static_cast<SpacePhaseFunction::Kind>(std::find(all.begin(), all.end(), word) -
                                               all.begin());
}

}  // namespace

double SpacePhaseFunction::density(double cosine) const {
  switch (kind) {
    case Kind::henyey_greenstein:
      return HenyeyGreenstein<3>{g}.density_at(cosine);
    case Kind::rayleigh:
      return 3 / (16 * pi) * (1 + cosine * cosine);
    default:
      return Isotropic<3>::value;
  }
}

Vec3 SpacePhaseFunction::sample(const Vec3& direction, RandomStream& random) const {
  const double u = random.uniform();
  switch (kind) {
    case Kind::henyey_greenstein:
      return random_turn(direction, HenyeyGreenstein<3>{g}.sample_one_minus_cosine(u), random);
    case Kind::rayleigh:
      return random_turn(direction, 1 - rayleigh_cosine(u), random);
    default:
      return random_turn(direction, 2 * u, random);
  }
}

void add_keys(Keys& keys, MediumValues& values, const std::string& prefix) {
  const std::string scattering = "a medium with " + prefix + "mu_s or " + prefix + "mu_a";
  keys.add(prefix + "mu_s", values.mu_s, "Scattering coefficient (default 0)")
      .not_negative()
      .unit("1/length");
  keys.add(prefix + "mu_a", values.mu_a, "Absorption coefficient (default 0)")
      .not_negative()
      .unit("1/length");
  keys.add(prefix + "phase", values.phase, "Phase function").one_of(words()).only_of(scattering);
  keys.add(prefix + "g", values.g, "Mean cosine").between(-1, 1).only_of("henyey_greenstein");
  keys.add(prefix + "density", values.density,
           "HDF5 with density[x, y, z], by which both coefficients are multiplied, and its "
           "attributes origin, spacing; 0 outside the grid")
      .file()
      .only_of(scattering);
}

ScatteringMedium make_medium(const Keys& keys, const MediumValues& values) {
  ScatteringMedium medium{keys.read(values.mu_s).value_or(0), keys.read(values.mu_a).value_or(0)};
  if (!values.mu_s && !values.mu_a) return medium;
  medium.phase.kind = kind_of(keys.read(values.phase));
  if (medium.phase.kind == SpacePhaseFunction::Kind::henyey_greenstein)
    medium.phase.g = keys.read(values.g);
  if (!keys.read(values.density).empty())
    medium.density = std::make_shared<DensityGrid>(
        read_grid_of<DensityGrid>(keys.name(values.density), values.density, "density"));
  return medium;
}

}  // namespace flatspeckle::grin

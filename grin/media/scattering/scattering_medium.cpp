#include "grin/media/scattering/scattering_medium.h"

#include "core/keys/kinds.h"
#include "grin/media/index/field_file.h"

namespace flatspeckle::grin {

void add_keys(Keys& keys, MediumValues& values, const std::string& prefix) {
  const std::string scattering = "a medium with " + prefix + "mu_s or " + prefix + "mu_a";
  keys.add(prefix + "mu_s", values.mu_s, "Scattering coefficient (default 0)")
      .not_negative()
      .unit("1/length");
  keys.add(prefix + "mu_a", values.mu_a, "Absorption coefficient (default 0)")
      .not_negative()
      .unit("1/length");
  keys.add(prefix + "phase", values.phase, "Phase function")
      .one_of(kind_words(values.kinds))
      .only_of(scattering);
  each_kind(values.kinds, [&](auto& kind) { add_keys(keys, kind, prefix); });
  keys.add(prefix + "density", values.density,
           "HDF5 with density[x, y, z], by which both coefficients are multiplied, and its "
           "attributes origin, spacing; 0 outside the grid")
      .file()
      .only_of(scattering);
}

ScatteringMedium make_medium(const Keys& keys, const MediumValues& values) {
  ScatteringMedium medium{keys.read(values.mu_s).value_or(0), keys.read(values.mu_a).value_or(0)};
  if (!values.mu_s && !values.mu_a) return medium;
  with_kind(values.kinds, keys.read(values.phase),
            [&](const auto& kind) { medium.phase.which = make_phase(keys, kind); });
  if (!keys.read(values.density).empty())
    medium.density =
        std::make_shared<DensityGrid>(read_field(keys, values.density, read_density_grid));
  return medium;
}

}  // namespace flatspeckle::grin

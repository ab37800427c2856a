#include "grin/media/scattering/scattering_medium.h"

#include <algorithm>
#include <cmath>

#include "core/keys/kinds.h"
#include "grin/media/index/field_file.h"
#include "grin/media/labels/label_volume.h"
#include "grin/media/scattering/labelled_media.h"

namespace flatspeckle::grin {

DensityGrid::DensityGrid(const FieldGrid& grid, std::span<const double> density)
    : grid_(grid),
      per_spacing_(grid.spacing.cwiseInverse()),
      density_(density.begin(), density.end()) {
  check(grid, density.size(), 2);
  for (const double value : density)
    if (!(value >= 0) || !std::isfinite(value))
      throw InputError("density", value, "must be finite and not negative");
  largest_ = *std::max_element(density.begin(), density.end());
}

double DensityGrid::operator()(const Vec3& x) const {
  const Vec3 position = (x - grid_.origin).cwiseProduct(per_spacing_);
  std::array<int, 3> cell;
  Vec3 t;
  for (int a = 0; a < 3; ++a) {
    if (!(position[a] >= 0 && position[a] <= grid_.nodes[a] - 1)) return 0;
    cell[a] = std::min(static_cast<int>(position[a]), grid_.nodes[a] - 2);
    t[a] = position[a] - cell[a];
  }
  const std::size_t y = grid_.nodes[2], x_stride = y * grid_.nodes[1];
  const double* corner = &density_[cell[0] * x_stride + cell[1] * y + cell[2]];
  const auto mix = [](double a, double b, double part) { return a + part * (b - a); };
  const auto edge = [&](const double* at) { return mix(at[0], at[1], t[2]); };
  const auto face = [&](const double* at) { return mix(edge(at), edge(at + y), t[1]); };
  return mix(face(corner), face(corner + x_stride), t[0]);
}

DensityGrid read_density_grid(const std::filesystem::path& path) {
  return read_grid<DensityGrid>(path, "density");
}

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
  keys.add(
          prefix + "labels", values.labels,
          "Labels of voxels, which select their media in " + prefix +
              "label_media, instead of mu_s and mu_a: HDF5 with labels[x, y, z] and its attributes "
              "origin, spacing; NIfTI-1 (.nii); or shapes of an MCX scene (.json)")
      .file();
  keys.add(prefix + "label_media", values.label_media,
           "mu_s mu_a g of each label, from label 0 on, which is also the medium outside of the "
           "voxels")
      .each_of(3, "mu_s mu_a g")
      .only_of(prefix + "labels");
}

ScatteringMedium make_medium(const Keys& keys, const MediumValues& values) {
  if (!keys.read(values.labels).empty())
    return labelled_medium(read_field(keys, values.labels, read_labels),
                           keys.required(values.label_media), keys.name(values.label_media));
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

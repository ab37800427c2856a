#include "grin/media/scattering/density_grid.h"

#include <algorithm>
#include <cmath>

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

}  // namespace flatspeckle::grin

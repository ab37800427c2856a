#include "wave_solver/periodic/cell_map.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/result/result_group.h"
#include "wave_solver/periodic/matrix_job.h"

namespace flatspeckle::wave {

namespace {

using Amplitudes = std::vector<Complex>;  // of the light channels of the front, with unit flux

struct MappedLight {
  Amplitudes wave;
  double transmittance;
};

std::vector<MappedLight> mapped_lights(const ScatteringMatrix& found,
                                       std::span<const std::int64_t> numbers) {
  const std::size_t n = found.channels.size();
  const auto t = found.quarter(false, true);
  const auto normal = std::ranges::min_element(
      found.channels, {}, [](const CellChannel& channel) { return std::abs(channel.sine); });
  const auto a = static_cast<std::size_t>(normal - found.channels.begin());
  MappedLight one{Amplitudes(n), 0};
  one.wave[a] = 1;
  for (std::size_t b = 0; b < n; ++b) one.transmittance += std::norm(t[b + n * a]);
  std::vector<MappedLight> lights = {one};
  const Eigenchannels all = eigenchannels(t, n);
  for (const std::int64_t number : numbers) {
    const auto m = static_cast<std::size_t>(number);
    lights.push_back({all.waves[m], all.eigenvalues[m]});
  }
  return lights;
}

std::vector<PlaneWave> incident(const ScatteringMatrix& found, const Amplitudes& light) {
  std::vector<PlaneWave> waves;
  for (std::size_t a = 0; a < light.size(); ++a) {
    const auto& [number, sine, cosine] = found.channels[a];
    waves.push_back({{sine, cosine}, light[a] / std::sqrt(cosine), {}});
  }
  return waves;
}

// Repeats the coefficients of all lights for the near copies, in the order of with_copies().
Amplitudes repeated(const Amplitudes& x, std::size_t n, const Copies& copies) {
  Amplitudes all;
  for (std::size_t first = 0; first < x.size(); first += n) {
    const auto append = [&](Complex factor) {
      for (std::size_t i = 0; i < n; ++i) all.push_back(factor * x[first + i]);
    };
    append(1);
    for (int m = 1; m <= copies.count; ++m)
      for (const int side : {-m, m}) append(copies.factor(side));
  }
  return all;
}

}  // namespace

// Bases are large enough for points at the rims of all scatterers.
std::string write_cell_map(ResultFile& file, const Placement& placement, double k,
                           const CellImages& images, const ScatteringMatrix& found,
                           std::span<const std::int64_t> numbers, const SolveOptions& options,
                           const MapGrid& grid) {
  std::vector<Vec> rims;
  for (const auto& [centre, scatterer] : placement)
    if (scatterer.is_disk()) rims.push_back(centre + Vec{scatterer.radius, 0});
  const PeriodicCell cell(placement, k, images, options.tolerance, rims);
  const std::size_t n = cell.unknowns();
  std::vector<std::vector<PlaneWave>> lights;
  Amplitudes rhs;
  std::vector<double> transmittance;
  for (const MappedLight& light : mapped_lights(found, numbers)) {
    transmittance.push_back(light.transmittance);
    lights.push_back(incident(found, light.wave));
    const auto side = cell.right_hand_side(lights.back());
    rhs.insert(rhs.end(), side.begin(), side.end());
  }
  Amplitudes x;
  if (n > 0) {
    EquationSolver solver(cell.equations(), cell_method(n, options), options.tolerance);
    auto solution = cell.solve(cell.whole(solver), rhs);
    for (std::size_t light = 0; light < lights.size(); ++light) {
      const auto more = cell.image_field(solution, light);
      lights[light].insert(lights[light].end(), more.begin(), more.end());
    }
    x = repeated(solution.x, n, cell.near().copies());
  }
  file.bind("LIGHT", {"map_wave"});
  const ResultGroup root(file, scattering_matrix_table);
  root.number("map_wave", lights.size());
  root.put("map_transmittance", transmittance);
  const TMatrixSystem all = cell.near().with_explicit_copies();
  return write_map(file, {&all, std::move(lights), x}, grid, options.tolerance);
}

}  // namespace flatspeckle::wave

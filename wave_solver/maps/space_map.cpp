#include "wave_solver/maps/space_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/bessel.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/equations/rim_waves.h"
#include "wave_solver/spheres/incident_waves.h"

namespace flatspeckle::wave {

namespace {

constexpr std::size_t points_per_part = 64;

// Returns j_l(z) / j_l(z_0) for l = 0 .. order, with Im z >= 0 and |z| <= |z_0|. Ratios of
// consecutive orders give the j_l up to a factor, which follows from j_0 or j_1, whichever is
// larger.
std::vector<Complex> interior_waves(int order, ExtendedComplex z, ExtendedComplex z_0) {
  const ExtendedComplex turn = std::exp(ExtendedComplex(0, 1) * (z_0 - z));
  const auto scaled = [&](ExtendedComplex at) {  // j_l(at) e^{i at}
    std::vector<ExtendedComplex> j(order + 1, 0);
    if (at == 0.0L) {
      j[0] = 1;
      return j;
    }
    const auto ratios = bessel_ratios(std::max(order, 1), at, Radial::spherical);
    const ExtendedComplex i(0, 1), twice = std::exp(2.0L * i * at);
    const ExtendedComplex sine = (twice - 1.0L) / (2.0L * i), cosine = (twice + 1.0L) / 2.0L;
    j[0] = std::abs(ratios[0]) > 1 ? (sine / at - cosine) / at / ratios[0] : sine / at;
    for (int l = 1; l <= order; ++l) j[l] = j[l - 1] * ratios[l - 1];
    return j;
  };
  const auto here = scaled(z), there = scaled(z_0);
  std::vector<Complex> waves(order + 1);
  for (int l = 0; l <= order; ++l) waves[l] = Complex(here[l] / there[l] * turn);
  return waves;
}

// Returns the field in a penetrable sphere for one light.
Complex inside_sphere(const SphereEquations& equations, std::size_t sphere,
                      std::span<const Complex> beta, const std::vector<RimWave>& rim, Vec point) {
  const auto& [centre, scatterer] = equations.placement()[sphere];
  const Vec d = point - centre;
  const double r = length(d);
  const ExtendedComplex mk =
      ExtendedComplex(scatterer.index) * static_cast<long double>(equations.k());
  const auto waves =
      interior_waves(static_cast<int>(rim.size()) - 1, mk * static_cast<long double>(r),
                     mk * static_cast<long double>(scatterer.radius));
  const auto harmonics =
      Harmonics(static_cast<int>(rim.size()) - 1).at(r > 0 ? (1 / r) * d : Vec{0, 1});
  Complex sum = 0;
  for (std::size_t l = 0; l < rim.size(); ++l)
    for (std::size_t i = harmonic_index(static_cast<int>(l), 0);
         i < harmonics_up_to(static_cast<int>(l)); ++i)
      sum += beta[i] * harmonics[i] * (waves[l] * Complex(rim[l].field));
  return sum;
}

// Adds the light and the waves of all scatterers at points: field[light][point]. The waves of a
// scatterer at its own place are left out.
void add_outside(const SpaceSolution& solution, std::span<const Vec> points, double tolerance,
                 std::span<Complex> field) {
  const SphereEquations& equations = solution.equations();
  const std::size_t lights = solution.lights().size(), count = points.size();
  constexpr long double one = 1;
  std::vector<SphereSet> sets;  // the field is the coefficient of j_0 R_00, times R_00
  for (const Vec& point : points) sets.push_back({point, 0, {&one, 1}});
  const Complex unit = 1 / std::sqrt(4 * std::numbers::pi);
  for (std::size_t light = 0; light < lights; ++light)
    add_incident(equations.k(), sets, solution.lights()[light], tolerance, unit,
                 field.subspan(light * count, count));
  std::vector<Complex> block;
  for (std::size_t j = 0; j < equations.placement().size(); ++j) {
    const Vec centre = equations.placement()[j].position;
    const double on_it = FieldMap::on_a_point * 2 * std::numbers::pi / equations.k();
    std::vector<Vec> apart(points.begin(), points.end());
    for (Vec& point : apart)
      if (length(point - centre) < on_it) point = centre + Vec{1 / equations.k(), 0};
    const std::size_t first = equations.first(j), width = equations.first(j + 1) - first;
    block.resize(count * width);
    field_at(equations.k(), apart, equations.waves(j), {block.data(), count});
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t n = 0; n < width && length(points[i] - centre) < on_it; ++n)
        block[i + n * count] = 0;
    multiply(CblasNoTrans, CblasNoTrans, count, lights, width, 1, block.data(), count,
             &solution.coefficients(0)[first], equations.unknowns(), 1, field.data(), count);
  }
}

// Replaces the values at points inside spheres.
void replace_inside(const SpaceSolution& solution, std::span<const Vec> points,
                    std::span<Complex> field) {
  const SphereEquations& equations = solution.equations();
  for (std::size_t j = 0; j < equations.placement().size(); ++j) {
    const auto& [centre, scatterer] = equations.placement()[j];
    if (!scatterer.is_disk() || equations.t_matrix(equations.first(j)) == 0.0L) continue;
    std::vector<RimWave> rim;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (length(points[i] - centre) >= scatterer.radius) continue;
      if (scatterer.is_penetrable() && rim.empty())
        rim = rim_waves(scatterer, equations.k(), equations.order(j), Radial::spherical);
      for (std::size_t light = 0; light < solution.lights().size(); ++light)
        field[light * points.size() + i] =
            rim.empty() ? 0
                        : inside_sphere(equations, j,
                                        solution.coefficients(light).subspan(equations.first(j)),
                                        rim, points[i]);
    }
  }
}

}  // namespace

std::vector<Complex> total_field(const SpaceSolution& solution, std::span<const Vec> points,
                                 double tolerance) {
  const std::size_t lights = solution.lights().size();
  std::vector<Complex> field(lights * points.size());
  parallel_for((points.size() + points_per_part - 1) / points_per_part, [&](std::size_t part) {
    const std::size_t first = part * points_per_part,
                      count = std::min(points_per_part, points.size() - first);
    std::vector<Complex> sum(lights * count);
    add_outside(solution, points.subspan(first, count), tolerance, sum);
    replace_inside(solution, points.subspan(first, count), sum);
    for (std::size_t light = 0; light < lights; ++light)
      std::copy_n(&sum[light * count], count, &field[light * points.size() + first]);
  });
  return field;
}

std::vector<Vec> map_sensors(const MapGrid& grid, double y, const Placement& placement) {
  std::vector<Vec> sensors;
  for (const auto& [centre, scatterer] : placement) {
    if (!scatterer.is_disk()) continue;
    const Vec nearest{std::clamp(centre.x, grid.low.x, grid.high.x),
                      std::clamp(centre.z, grid.low.z, grid.high.z), y};
    const bool touched = length(nearest - centre) <= scatterer.radius;
    sensors.push_back(touched ? centre + Vec{scatterer.radius, 0} : nearest);
  }
  return sensors;
}

std::string write_map(ResultFile& file, const SpaceSolution& solution, const MapGrid& grid,
                      double y, double tolerance) {
  constexpr std::size_t pixels = 1 << 14;
  write_tiles(file, grid, solution.equations().k(), solution.lights().size(), tiles(grid, pixels),
              [&](const MapTile& tile) {
                std::vector<Vec> points;
                for (std::size_t iz = tile.iz; iz < tile.iz + tile.nz; ++iz)
                  for (std::size_t ix = tile.ix; ix < tile.ix + tile.nx; ++ix) {
                    points.push_back(grid.pixel(ix, iz));
                    points.back().y = y;
                  }
                return total_field(solution, points, tolerance);
              });
  return "map: direct sums";
}

}  // namespace flatspeckle::wave

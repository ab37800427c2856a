#include "wave_solver/solutions/boundary_residual.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "wave_solver/dense/blas.h"
#include "wave_solver/equations/neighbours.h"
#include "wave_solver/equations/rim_waves.h"

namespace flatspeckle::wave {

namespace {

using Kind = Scatterer::Kind;

// A disk, with the gap to its closest neighbour and the direction towards it.
struct Rim {
  std::size_t disk = 0;
  double gap = 0;
  double angle = 0;  // towards the neighbour
};

Rim rim_of(const Placement& placement, std::size_t disk, const std::vector<Neighbour>& around) {
  if (around.empty()) return {disk, std::numeric_limits<double>::infinity(), 0};
  const auto& [position, scatterer] = placement[disk];
  const auto& other = placement[around[0].scatterer];
  return {disk, around[0].distance - scatterer.radius - other.scatterer.disk_radius(),
          angle_of(other.position - position)};
}

std::vector<Rim> narrowest(const Placement& placement) {
  constexpr std::size_t most = 16;
  if (std::none_of(placement.begin(), placement.end(),
                   [](const auto& placed) { return placed.scatterer.is_disk(); }))
    return {};
  const auto around = neighbours(placement, 1);
  std::vector<Rim> rims;
  for (std::size_t j = 0; j < placement.size(); ++j) {
    if (!placement[j].scatterer.is_disk()) continue;
    rims.push_back(rim_of(placement, j, around[j]));
  }
  std::stable_sort(rims.begin(), rims.end(),
                   [](const Rim& a, const Rim& b) { return a.gap < b.gap; });
  rims.resize(std::min(rims.size(), most));
  return rims;
}

// A field u at a point of a rim, and du/dr / k with its radial derivative.
struct RimField {
  Complex field, derivative;
};

// Scattered field and its derivative (RimField) for all lights at points on a rim: [light][point].
struct Traces {
  std::vector<Complex> field, derivative;
};

// Adds the fields scattered by scatterers begin .. end - 1, with one matrix product for all lights.
void add_traces(const WaveSolution& solution, std::size_t begin, std::size_t end,
                std::span<const Vec> points, std::span<const Vec> normals, Traces& traces) {
  const TMatrixSystem& system = solution.system();
  const std::size_t count = points.size(), first = system.first(begin),
                    unknowns = system.first(end) - first;
  std::vector<Complex> values(count * unknowns), derivatives(values.size());
  for (std::size_t j = begin; j < end; ++j) {
    const ModeSet sender = system.modes(j);
    const std::size_t at = (system.first(j) - first) * count;
    field_at(system.k(), points, sender, {&values[at], count});
    directional_derivatives(system.k(), points, normals, sender, {&derivatives[at], count});
  }
  const Complex* beta = &solution.coefficients(0)[first];
  const auto add = [&](const std::vector<Complex>& rows, std::vector<Complex>& sums) {
    multiply(CblasNoTrans, CblasNoTrans, count, solution.light_angles().size(), unknowns, 1,
             rows.data(), count, beta, system.unknowns(), 1, sums.data(), count);
  };
  add(values, traces.field);
  add(derivatives, traces.derivative);
}

Traces scattered_traces(const WaveSolution& solution, std::span<const Vec> points,
                        std::span<const Vec> normals) {
  constexpr std::size_t block = 2000;  // unknowns
  const TMatrixSystem& system = solution.system();
  const std::size_t disks = system.placement().size();
  const std::vector<Complex> nothing(solution.light_angles().size() * points.size());
  Traces traces{nothing, nothing};
  for (std::size_t begin = 0, end = 1; begin < disks; begin = end++) {
    while (end < disks && system.first(end + 1) - system.first(begin) <= block) ++end;
    add_traces(solution, begin, end, points, normals, traces);
  }
  return traces;
}

RimField incident(double k, double light_angle, Vec point, Vec normal) {
  const Vec w = direction(light_angle);
  const Complex wave = std::polar(1.0, k * dot(w, point));
  return {wave, Complex(0, dot(w, normal)) * wave};
}

RimField total_inside(std::span<const Complex> beta, const ModeSet& modes,
                      const std::vector<RimWave>& waves, double angle) {
  RimField total{0, 0};
  for (std::size_t i = 0; i < modes.modes.size(); ++i) {
    const int n = modes.modes[i].order;
    const double turn = modes.modes[i].odd ? std::sin(n * angle) : std::cos(n * angle);
    const Complex factor = beta[i] * (n == 0 ? 1 : std::numbers::sqrt2) * turn;
    total.field += factor * Complex(waves[n].field);
    total.derivative += factor * Complex(waves[n].derivative);
  }
  return total;
}

double mismatch(Kind kind, const RimField& outside, const RimField& inside) {
  if (kind == Kind::soft) return std::abs(outside.field);
  if (kind == Kind::hard) return std::abs(outside.derivative);
  return std::max(std::abs(outside.field - inside.field),
                  std::abs(outside.derivative - inside.derivative));
}

double residual_on(const WaveSolution& solution, const Rim& rim) {
  const TMatrixSystem& system = solution.system();
  const auto& [position, scatterer] = system.placement()[rim.disk];
  const bool penetrable = scatterer.is_penetrable();
  if (penetrable && is_transparent(system, rim.disk)) return 0;
  const auto inside_waves = penetrable ? rim_waves(scatterer, system.k(), system.order(rim.disk))
                                       : std::vector<RimWave>{};
  const int count = 2 * std::min(system.order(rim.disk), 24) + 8;
  std::vector<double> angles;
  std::vector<Vec> normals, points;
  for (int i = 0; i < count; ++i) {
    angles.push_back(rim.angle + 2 * std::numbers::pi * i / count);
    normals.push_back(direction(angles.back()));
    points.push_back(position + scatterer.radius * normals.back());
  }
  const auto scattered = scattered_traces(solution, points, normals);
  double worst = 0;
  for (std::size_t light = 0; light < solution.light_angles().size(); ++light) {
    const auto beta = solution.coefficients(light).subspan(system.first(rim.disk));
    for (int i = 0; i < count; ++i) {
      RimField outside =
          incident(system.k(), solution.light_angles()[light], points[i], normals[i]);
      outside.field += scattered.field[light * count + i];
      outside.derivative += scattered.derivative[light * count + i];
      const RimField inside =
          penetrable ? total_inside(beta, system.modes(rim.disk), inside_waves, angles[i])
                     : RimField{};
      worst = std::max(worst, mismatch(scatterer.kind, outside, inside));
    }
  }
  return worst;
}

}  // namespace

double boundary_residual(const WaveSolution& solution) {
  if (solution.light_angles().empty()) return 0;
  double worst = 0;
  for (const Rim& rim : narrowest(solution.system().placement()))
    worst = std::max(worst, residual_on(solution, rim));
  return worst;
}

}  // namespace flatspeckle::wave

#include "wave_solver/boundary_residual.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/bessel.h"
#include "wave_solver/dense_solver.h"

namespace flatspeckle::wave {

namespace {

using Kind = Scatterer::Kind;

struct Neighbour {
  std::size_t disk = 0;
  double gap = 0;    // to the nearest other scatterer
  double angle = 0;  // in which direction that is
};

Neighbour nearest_neighbour(const Placement& placement, std::size_t disk) {
  Neighbour nearest{disk, std::numeric_limits<double>::infinity(), 0};
  for (std::size_t l = 0; l < placement.size(); ++l) {
    if (l == disk) continue;
    const Vec2 d = placement[l].position - placement[disk].position;
    const Scatterer& other = placement[l].scatterer;
    const double gap =
        length(d) - placement[disk].scatterer.radius - (other.is_disk() ? other.radius : 0);
    if (gap < nearest.gap) nearest = {disk, gap, angle_of(d)};
  }
  return nearest;
}

std::vector<Neighbour> narrowest(const Placement& placement) {
  constexpr std::size_t most = 16;
  std::vector<Neighbour> all;
  for (std::size_t j = 0; j < placement.size(); ++j)
    if (placement[j].scatterer.is_disk()) all.push_back(nearest_neighbour(placement, j));
  std::stable_sort(all.begin(), all.end(),
                   [](const Neighbour& a, const Neighbour& b) { return a.gap < b.gap; });
  all.resize(std::min(all.size(), most));
  return all;
}

// A field and its derivative along r, divided by k.
struct Trace {
  Complex field, slope;
};

Trace total_outside(const WaveSolution& solution, std::size_t light, Vec2 point, Vec2 normal,
                    const std::vector<TMatrixSystem::Outgoing>& waves) {
  const TMatrixSystem& system = solution.system();
  const Vec2 w = direction(solution.light_angles()[light]);
  const Complex incident = std::polar(1.0, system.k() * dot(w, point));
  Trace total{incident, Complex(0, dot(w, normal)) * incident};
  const auto beta = solution.coefficients(light);
  for (std::size_t j = 0; j < waves.size(); ++j)
    for (std::size_t n = 0; n < waves[j].field.size(); ++n) {
      total.field += beta[system.first(j) + n] * waves[j].field[n];
      total.slope += beta[system.first(j) + n] * waves[j].derivative[n];
    }
  return total;
}

// Per unknown of a penetrable disk, what it adds at the rim's angle 0 to the field inside, whose
// coefficients follow from continuity of u: (J_n(x)/tau_n + tau_n H_n(x)), and to the slope that
// the outside must have, q J_n'(mx)/J_n(mx) times that (C7).
std::vector<Trace> interior_waves(const TMatrixSystem& system, std::size_t disk) {
  const Scatterer& cylinder = system.placement()[disk].scatterer;
  const int order = system.order(disk);
  const double x = system.k() * cylinder.radius;
  const ExtendedComplex m(cylinder.index);
  const ExtendedComplex q = cylinder.kind == Kind::tm ? m : 1.0L / m;
  const auto j = bessel_j(order, x);
  const auto h = hankel(order, x);
  const auto ratios = bessel_ratios(order, m * static_cast<long double>(x));
  std::vector<Trace> waves(order + 1);
  for (int n = 0; n <= order; ++n) {
    const ExtendedComplex tau = system.tau(disk)[n];
    const ExtendedComplex u = j[n] / tau + tau * h[n];
    const ExtendedComplex slope =
        q * (static_cast<long double>(n) / (m * static_cast<long double>(x)) - ratios[n]);
    waves[n] = {Complex(u), Complex(u * slope)};
  }
  return waves;
}

Trace total_inside(std::span<const Complex> beta, const std::vector<Trace>& waves, double angle) {
  const int order = static_cast<int>(waves.size()) - 1;
  Trace total{0, 0};
  for (int n = -order; n <= order; ++n) {
    const double sign = n < 0 && n % 2 != 0 ? -1 : 1;  // J_{-n} = (-1)^n J_n
    const Complex factor = beta[order + n] * sign * std::polar(1.0, n * angle);
    total.field += factor * waves[std::abs(n)].field;
    total.slope += factor * waves[std::abs(n)].slope;
  }
  return total;
}

double mismatch(Kind kind, const Trace& outside, const Trace& inside) {
  if (kind == Kind::soft) return std::abs(outside.field);
  if (kind == Kind::hard) return std::abs(outside.slope);
  return std::max(std::abs(outside.field - inside.field), std::abs(outside.slope - inside.slope));
}

double residual_on(const WaveSolution& solution, const Neighbour& rim) {
  const TMatrixSystem& system = solution.system();
  const auto& [position, scatterer] = system.placement()[rim.disk];
  const bool penetrable = scatterer.kind == Kind::tm || scatterer.kind == Kind::te;
  if (penetrable && system.tau(rim.disk)[0] == 0.0L) return 0;  // index 1: nothing is there
  const auto inside_waves = penetrable ? interior_waves(system, rim.disk) : std::vector<Trace>{};
  const int points = 2 * std::min(system.order(rim.disk), 24) + 8;
  double worst = 0;
  for (int i = 0; i < points; ++i) {
    const double angle = rim.angle + 2 * std::numbers::pi * i / points;
    const Vec2 normal = direction(angle), point = position + scatterer.radius * normal;
    std::vector<TMatrixSystem::Outgoing> waves;
    for (std::size_t j = 0; j < system.placement().size(); ++j)
      waves.push_back(system.outgoing(j, point, normal));
    for (std::size_t light = 0; light < solution.light_angles().size(); ++light) {
      const auto beta = solution.coefficients(light).subspan(system.first(rim.disk),
                                                             2 * system.order(rim.disk) + 1);
      const Trace inside = penetrable ? total_inside(beta, inside_waves, angle) : Trace{};
      const Trace outside = total_outside(solution, light, point, normal, waves);
      worst = std::max(worst, mismatch(scatterer.kind, outside, inside));
    }
  }
  return worst;
}

}  // namespace

double boundary_residual(const WaveSolution& solution) {
  double worst = 0;
  for (const Neighbour& rim : narrowest(solution.system().placement()))
    worst = std::max(worst, residual_on(solution, rim));
  return worst;
}

}  // namespace flatspeckle::wave

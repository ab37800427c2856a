#include "wave_solver/solutions/space_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/numbers/gauss.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/equations/neighbours.h"
#include "wave_solver/equations/rim_waves.h"
#include "wave_solver/spheres/incident_waves.h"

namespace flatspeckle::wave {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

// A sphere, the gap to its closest neighbour and the direction towards it.
struct Surface {
  std::size_t sphere = 0;
  double gap = 0;
  Vec towards;
};

std::vector<Surface> narrowest_gaps(const Placement& placement) {
  constexpr std::size_t most = 16;
  std::vector<Surface> surfaces;
  if (std::ranges::none_of(placement,
                           [](const auto& placed) { return placed.scatterer.is_disk(); }))
    return surfaces;
  const auto around = neighbours(placement, 1);
  for (std::size_t j = 0; j < placement.size(); ++j) {
    const auto& [position, scatterer] = placement[j];
    if (!scatterer.is_disk()) continue;
    if (around[j].empty()) {
      surfaces.push_back({j, std::numeric_limits<double>::infinity(), {0, 1}});
      continue;
    }
    const PlacedScatterer& other = placement[around[j][0].scatterer];
    const Vec d = other.position - position;
    surfaces.push_back(
        {j, length(d) - scatterer.radius - other.scatterer.disk_radius(), (1 / length(d)) * d});
  }
  std::ranges::stable_sort(surfaces, {}, &Surface::gap);
  surfaces.resize(std::min(surfaces.size(), most));
  return surfaces;
}

// Returns directions that are spread evenly over the sphere, the first of which is `pole`.
std::vector<Vec> spread_directions(Vec pole, int count) {
  const Vec aside = std::abs(pole.z) < 0.9 ? Vec{0, 1} : Vec{1, 0};
  const Vec across = cross(pole, aside), u = (1 / length(across)) * across, v = cross(pole, u);
  std::vector<Vec> directions;
  for (int i = 0; i < count; ++i) {
    const double cosine = 1 - 2.0 * i / count, sine = std::sqrt(1 - cosine * cosine),
                 azimuth = two_pi * std::numbers::phi * i;
    directions.push_back(cosine * pole + (sine * std::cos(azimuth)) * u +
                         (sine * std::sin(azimuth)) * v);
  }
  return directions;
}

// A field u at a point of a surface, and du/dr / k with its radial derivative.
struct SurfaceField {
  Complex field, derivative;
};

// Returns u and du/dr / k from the coefficients of the regular waves of degrees 0 and 1 about the
// point: u = c_00 R_00, and near the point j_1(k r) = k r / 3.
SurfaceField at_point(const Complex* c, Vec normal) {
  const double scale = std::sqrt(3 / (4 * std::numbers::pi)) / 3;
  return {c[0] / std::sqrt(4 * std::numbers::pi),
          scale * (c[1] * normal.z + c[2] * normal.x + c[3] * normal.y)};
}

SurfaceField inside_at(std::span<const Complex> beta, const std::vector<RimWave>& waves,
                       Vec normal) {
  SurfaceField total{0, 0};
  const int order = static_cast<int>(waves.size()) - 1;
  const auto harmonics = Harmonics(order).at(normal);
  for (int l = 0; l <= order; ++l)
    for (std::size_t i = harmonic_index(l, 0); i < harmonics_up_to(l); ++i) {
      total.field += beta[i] * harmonics[i] * Complex(waves[l].field);
      total.derivative += beta[i] * harmonics[i] * Complex(waves[l].derivative);
    }
  return total;
}

double mismatch_at(Scatterer::Kind kind, const SurfaceField& outside, const SurfaceField& inside) {
  if (kind == Scatterer::Kind::soft) return std::abs(outside.field);
  if (kind == Scatterer::Kind::hard) return std::abs(outside.derivative);
  return std::max(std::abs(outside.field - inside.field),
                  std::abs(outside.derivative - inside.derivative));
}

// Returns the coefficients of the total field in regular waves of degrees 0 and 1 about points
// outside the spheres: [light][point][wave].
std::vector<Complex> total_about(const SpaceSolution& solution, std::span<const SphereSet> points,
                                 double tolerance) {
  const SphereEquations& equations = solution.equations();
  const std::size_t rows = 4 * points.size(), lights = solution.lights().size();
  std::vector<Complex> total(lights * rows), block;
  for (std::size_t light = 0; light < lights; ++light)
    add_incident(equations.k(), points, solution.lights()[light], tolerance, 1,
                 std::span(total).subspan(light * rows, rows));
  for (std::size_t j = 0; j < equations.placement().size(); ++j) {
    const std::size_t first = equations.first(j), width = equations.first(j + 1) - first;
    block.resize(rows * width);
    translate(equations.k(), points, equations.waves(j), {block.data(), rows});
    multiply(CblasNoTrans, CblasNoTrans, rows, lights, width, 1, block.data(), rows,
             &solution.coefficients(0)[first], equations.unknowns(), 1, total.data(), rows);
  }
  return total;
}

double residual_on(const SpaceSolution& solution, const Surface& surface, double tolerance) {
  const SphereEquations& equations = solution.equations();
  const auto& [position, scatterer] = equations.placement()[surface.sphere];
  const std::size_t first = equations.first(surface.sphere);
  if (equations.t_matrix(first) == 0.0L) return 0;  // transparent
  const auto waves =
      scatterer.is_penetrable()
          ? rim_waves(scatterer, equations.k(), equations.order(surface.sphere), Radial::spherical)
          : std::vector<RimWave>{};
  const auto normals =
      spread_directions(surface.towards, 4 * std::min(equations.order(surface.sphere), 24) + 12);
  constexpr long double one[2] = {1, 1};
  std::vector<SphereSet> points;
  for (const Vec& normal : normals)
    points.push_back({position + scatterer.radius * normal, 1, one});
  const auto total = total_about(solution, points, tolerance);
  double worst = 0;
  for (std::size_t i = 0; i < total.size() / 4; ++i) {
    const Vec normal = normals[i % normals.size()];
    const auto beta = solution.coefficients(i / normals.size()).subspan(first);
    const SurfaceField inside =
        scatterer.is_penetrable() ? inside_at(beta, waves, normal) : SurfaceField{};
    worst = std::max(worst, mismatch_at(scatterer.kind, at_point(&total[4 * i], normal), inside));
  }
  return worst;
}

// Returns, for each unknown, the power that its scatterer absorbs if the unknown has the absolute
// value 1: (-Re T - |T|^2) / (k^2 |T|).
std::vector<double> absorption_in(const SphereEquations& equations) {
  std::vector<double> absorbed(equations.unknowns());
  const double square = equations.k() * equations.k();
  for (std::size_t j = 0; j < equations.placement().size(); ++j) {
    const Scatterer& own = equations.placement()[j].scatterer;
    const bool absorbs = own.kind == Scatterer::Kind::point
                             ? own.albedo != 1
                             : own.is_penetrable() && own.index.imag() != 0;
    for (std::size_t i = equations.first(j); absorbs && i < equations.first(j + 1); ++i) {
      const ExtendedComplex t = equations.t_matrix(i);
      if (t != 0.0L)
        absorbed[i] = static_cast<double>((-t.real() - std::norm(t)) / std::abs(t)) / square;
    }
  }
  return absorbed;
}

SphereRule rule_for(const SphereEquations& equations) {
  Vec low = equations.placement().front().position, high = low;
  for (const auto& [r, scatterer] : equations.placement()) {
    low = {std::min(low.x, r.x), std::min(low.z, r.z), std::min(low.y, r.y)};
    high = {std::max(high.x, r.x), std::max(high.z, r.z), std::max(high.y, r.y)};
  }
  double size = 0;
  for (const auto& [r, scatterer] : equations.placement())
    size =
        std::max(size, equations.k() * (length(r - 0.5 * (low + high)) + scatterer.disk_radius()));
  return sphere_rule(size);
}

double scattered_power(const SpaceSolution& solution, std::size_t light) {
  constexpr std::size_t at_once = 64;
  constexpr double most = 5e8;  // waves times directions; about five seconds
  const SphereRule rule = rule_for(solution.equations());
  if (static_cast<double>(rule.views.size()) *
          static_cast<double>(solution.equations().unknowns()) >
      most)
    return power_of_waves(solution, light);
  const std::size_t parts = (rule.views.size() + at_once - 1) / at_once,
                    n = solution.equations().unknowns();
  std::vector<double> sums(parts);
  parallel_for(parts, [&](std::size_t part) {
    const std::size_t first = part * at_once, count = std::min(at_once, rule.views.size() - first);
    const auto rows = solution.equations().view_rows(std::span(rule.views).subspan(first, count));
    const auto amplitudes = transposed_product(rows, solution.coefficients(light).data(), 1, n);
    for (std::size_t i = 0; i < count; ++i)
      sums[part] += rule.weights[first + i] * std::norm(amplitudes[i]);
  });
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

}  // namespace

SphereRule sphere_rule(double size) {
  const int degree = static_cast<int>(size + 10 * std::cbrt(size) + 10), turns = 2 * degree + 1;
  const auto polar = gauss_legendre(degree + 1);
  SphereRule rule;
  for (std::size_t i = 0; i < polar.node.size(); ++i)
    for (int n = 0; n < turns; ++n) {
      rule.views.push_back(far_view(std::acos(2 * polar.node[i] - 1), two_pi * n / turns));
      rule.weights.push_back(2 * polar.weight[i] * two_pi / turns);
    }
  return rule;
}

double power_of_waves(const SpaceSolution& solution, std::size_t light) {
  const SphereEquations& equations = solution.equations();
  const auto beta = solution.coefficients(light);
  const auto product = equations.apply(beta);
  double sum = 0;
  for (std::size_t i = 0; i < beta.size(); ++i) {
    const double size = equations.strength(i);
    const Complex diagonal = size > 0 ? -size / Complex(equations.t_matrix(i)) : Complex(1);
    sum +=
        size * std::norm(beta[i]) + (std::conj(beta[i]) * (product[i] - diagonal * beta[i])).real();
  }
  return sum / (equations.k() * equations.k());
}

double boundary_residual(const SpaceSolution& solution, double tolerance) {
  if (solution.lights().empty()) return 0;
  double worst = 0;
  for (const Surface& surface : narrowest_gaps(solution.equations().placement()))
    worst = std::max(worst, residual_on(solution, surface, tolerance));
  return worst;
}

Invariant power_balance(const SpaceSolution& solution) {
  constexpr std::size_t most_lights = 2;
  const SphereEquations& equations = solution.equations();
  const auto absorption = absorption_in(equations);
  Invariant worst;
  std::size_t checked = 0;
  for (std::size_t light = 0; light < solution.lights().size() && checked < most_lights; ++light) {
    const Light& own = solution.lights()[light];
    if (own.kind != Light::Kind::plane) continue;
    const View forward = far_view(own.angle, own.azimuth);
    const Complex amplitude =
        transposed_product(equations.view_rows({&forward, 1}), solution.coefficients(light).data(),
                           1, equations.unknowns())[0];
    const double unit = 4 * std::numbers::pi / equations.k();
    double absorbed = 0, squares = 0;
    const auto beta = solution.coefficients(light);
    for (std::size_t i = 0; i < beta.size(); ++i) {
      absorbed += absorption[i] * std::norm(beta[i]);
      squares += std::norm(beta[i]) / (equations.k() * equations.k());
    }
    const double scattered = scattered_power(solution, light),
                 all = std::max(unit * amplitude.imag(), scattered + absorbed);
    if (all == 0) continue;
    const double slack = 1e-13 + 100 * std::max(0.0, solution.diagnosis().residual);
    const Invariant found{std::abs(unit * amplitude.imag() - scattered - absorbed) / all,
                          slack * (unit * std::abs(amplitude) + squares) / all};
    if (checked++ == 0 || found.is_worse_than(worst)) worst = found;
  }
  return worst;
}

}  // namespace flatspeckle::wave

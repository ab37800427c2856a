#include "wave_extremes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <math.h>  // jn and yn are POSIX
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/random.h"
#include "wave_solver/wave_solution.h"

namespace flatspeckle::wave {

namespace {

using Kind = Scatterer::Kind;
constexpr double pi = std::numbers::pi, k = 2 * pi;
const std::vector<double> lights{0.3, 1.4 + pi};

Scatterer disk(Kind kind, double ka, Complex index = 1.5) {
  Scatterer scatterer;
  scatterer.kind = kind;
  scatterer.radius = ka / k;
  scatterer.index = index;
  return scatterer;
}

// Two equal disks along the z axis, the origin between them; gap in radii.
Placement pair(const Scatterer& scatterer, double gap) {
  const double half = (1 + gap / 2) * scatterer.radius;
  return {{{0, -half}, scatterer}, {{0, half}, scatterer}};
}

WaveSolution solved(const Placement& placement, double tolerance, bool diagnose = false) {
  return solve(placement, k, lights, {.tolerance = tolerance, .sensors = {}, .diagnose = diagnose});
}

std::vector<View> views_around() {
  std::vector<View> views;
  for (int i = 0; i < 36; ++i) views.push_back(far_view(2 * pi * i / 36));
  return views;
}

double distance(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference += std::norm(a[i] - b[i]);
    size += std::norm(b[i]);
  }
  return std::sqrt(difference / size);
}

// Far fields at two tolerances: the basis orders differ.
Finding convergence(const Placement& placement, double tolerance, double finer) {
  const auto views = views_around();
  return {
      distance(solved(placement, tolerance).fields(views), solved(placement, finer).fields(views)),
      tolerance,
      {}};
}

Placement many_points(std::size_t count, double width, double phase_shift) {
  Scatterer point;
  point.phase_shift = phase_shift;
  RandomStream random(1, 0, 0);
  Placement points;
  while (points.size() < count) {
    const double x = random.uniform(), z = random.uniform();
    points.push_back({{width * x, width * z}, point});
  }
  return points;
}

Finding reciprocity(const Placement& placement, double limit) {
  const auto solution = solved(placement, 1e-12);
  const Complex there = solution.far_field(lights[1] - pi, 0),
                back = solution.far_field(lights[0] + pi, 1);
  return {std::abs(there - back) / std::abs(there), limit, {}};
}

// Scattered against extinct power (C9); lossless disks only.
Finding energy(const Placement& placement, int views, double limit) {
  const auto solution = solved(placement, 1e-12);
  double scattered = 0;
  for (int i = 0; i < views; ++i)
    scattered += std::norm(solution.far_field(2 * pi * i / views)) * 2 * pi / views;
  const Complex forward = solution.far_field(lights[0]) * std::polar(1.0, pi / 4);
  const double lost = -std::sqrt(8 * pi / k) * forward.real();
  return {std::abs(scattered / lost - 1), limit, {}};
}

Finding boundary(const Placement& placement, double tolerance, double limit) {
  return {solved(placement, tolerance, true).diagnosis().boundary_residual, limit, {}};
}

// C7 word for word, with D_n = J_n'/J_n (mx) from J_n'/J_n = -(n/z) + 1 / (n-1)/z - D_{n-1}) turned
// downwards, and the C library's J and Y.
Complex textbook_t(const Scatterer& cylinder, int n) {
  const double x = k * cylinder.radius;
  const Complex mx = cylinder.index * x,
                q = cylinder.kind == Kind::tm ? cylinder.index : 1.0 / cylinder.index;
  const int start = n + 60 + static_cast<int>(1.2 * std::abs(mx));
  Complex d = 0;
  for (int m = start; m > n; --m)
    d = static_cast<double>(m - 1) / mx - 1.0 / (static_cast<double>(m) / mx + d);
  const double j = ::jn(n, x), slope = n / x * j - ::jn(n + 1, x), y = ::yn(n, x);
  const Complex h(j, y), h_slope(slope, n / x * y - ::yn(n + 1, x));
  return -(q * d * j - slope) / (q * d * h - h_slope);
}

Finding mie(const Scatterer& cylinder, double limit) {
  const double x = k * cylinder.radius, view = 2.0;
  Complex sum = textbook_t(cylinder, 0);
  for (int n = 1; n < x + 15 * std::cbrt(x) + 15; ++n)
    sum += 2.0 * textbook_t(cylinder, n) * std::cos(n * (view - lights[0]));
  const Complex expected = std::polar(std::sqrt(2 / (pi * k)), -pi / 4) * sum;
  const Complex found = solved({{{0, 0}, cylinder}}, 1e-14).far_field(view);
  return {std::abs(found - expected) / std::abs(expected), limit, {}};
}

// Statics: a pair's dipole moment, over that of two disks apart, is the sum over images
// R^n (sinh xi / sinh (n + 1) xi)^2, cosh xi = d / 2a, R the strength of one reflection.
Complex image_sum(double gap, Complex reflection) {
  const double xi = 2 * std::asinh(std::sqrt(gap) / 2);  // without loss at small gaps
  Complex sum = 0, power = 1;
  for (int n = 0; n < 1 || n * xi < 20; ++n) {
    const double ratio = std::sinh(xi) / std::sinh((n + 1) * xi);
    sum += power * ratio * ratio;
    if (std::abs(power) * ratio * ratio < 1e-17) break;
    power *= reflection;
  }
  return sum;
}

// Light and view along the axis or across it. reflection: of the axis' images.
Finding dipole(const Scatterer& small, double gap, Complex reflection, bool across,
               double tolerance, double limit) {
  const double angle = across ? pi / 2 : 0;
  const auto moment = [&](const Placement& placement) {
    const auto solution =
        solve(placement, k, {angle}, {.tolerance = tolerance, .sensors = {}, .diagnose = false});
    return solution.far_field(angle) - solution.far_field(angle + pi);
  };
  const Complex found = moment(pair(small, gap)) / (2.0 * moment({{{0, 0}, small}}));
  const Complex expected = image_sum(gap, across ? -reflection : reflection);
  return {std::abs(found - expected) / std::abs(expected), limit, {}};
}

// Monopoles: b = T_0 (a + H_0(kd) b), light across the axis.
Finding monopoles(const Scatterer& small, double limit) {
  const Placement two = pair(small, 2000);
  const double kd = k * length(two[1].position - two[0].position);
  const Complex t = static_cast<Complex>(t_matrix(small, k, 0)[0]);
  const Complex b = t / (1.0 - t * Complex(::j0(kd), ::y0(kd)));
  const Complex expected = std::polar(std::sqrt(2 / (pi * k)), -pi / 4) * 2.0 * b;
  const auto solution =
      solve(two, k, {pi / 2}, {.tolerance = 1e-12, .sensors = {}, .diagnose = false});
  return {std::abs(solution.far_field(pi / 2) - expected) / std::abs(expected), limit, {}};
}

// Almost invisible disks scatter independently.
Finding independent(const Scatterer& faint, double limit) {
  const Placement two = pair(faint, 0.5);
  const auto solution = solved(two, 1e-12), lone = solved({{{0, 0}, faint}}, 1e-12);
  std::vector<Complex> found, expected;
  for (const View& view : views_around()) {
    found.push_back(solution.far_field(view.angle));
    Complex phases = 0;
    for (const auto& [position, scatterer] : two)
      phases += std::polar(1.0, k * dot(direction(lights[0]) - direction(view.angle), position));
    expected.push_back(lone.far_field(view.angle) * phases);
  }
  return {distance(found, expected), limit, {}};
}

// The size parameter near `guess` at which order n of a disk of index 10 resonates: T_n = -1.
double resonance(int n, double low, double high) {
  const auto strength = [&](double x) {
    return std::abs(static_cast<Complex>(t_matrix(disk(Kind::tm, x, 10), k, n)[n]));
  };
  double best = low;
  for (double step = (high - low) / 2000; step > 1e-13; step /= 20) {
    for (double x = low; x <= high; x += step)
      if (strength(x) > strength(best)) best = x;
    low = best - step;
    high = best + step;
  }
  return best;
}

std::string named(const char* what, Kind kind) {
  const char* names[] = {"point", "soft", "hard", "TM", "TE"};
  return std::string(names[static_cast<int>(kind)]) + ", " + what;
}

using Cases = std::vector<ExtremeCase>;

void add(Cases& cases, std::string name, std::string invariant, std::function<Finding()> run,
         std::string must_say = {}) {
  cases.push_back({std::move(name), std::move(invariant), std::move(must_say), std::move(run)});
}

void add_gaps(Cases& cases) {
  for (const Kind kind : {Kind::soft, Kind::hard, Kind::tm, Kind::te}) {
    const Scatterer one = disk(kind, 1);
    add(cases, named("k a 1, gap 1e-3", kind), "far field at 1e-6 against 1e-9",
        [=] { return convergence(pair(one, 1e-3), 1e-6, 1e-9); });
    add(cases, named("k a 1, gap 1e-3", kind), "boundary residual",
        [=] { return boundary(pair(one, 1e-3), 1e-9, 1e-3); });
    if (kind != Kind::hard)
      add(cases, named("k a 1, gap 1e-6", kind), "far field at 1e-9 against 1e-12",
          [=] { return convergence(pair(one, 1e-6), 1e-9, 1e-12); });
  }
  for (const double ka : {0.01, 1.0, 10.0})
    add(
        cases, "hard, k a " + std::to_string(ka).substr(0, 5) + ", gap 1e-6",
        "refused, naming the order",
        [=] { return boundary(pair(disk(Kind::hard, ka), 1e-6), 1e-6, 0); },
        "basis order 70");  // 7.0e3: ln(1e6) / (2 xi), xi = 1e-3, with the gap rounded down
  for (const double gap : {1e-2, 1e-4}) {
    const std::string where = gap < 1e-3 ? "k a 1e-4, gap 1e-4" : "k a 1e-4, gap 1e-2";
    for (const bool across : {false, true}) {
      const std::string what = across ? "dipole across the axis" : "dipole along the axis";
      add(cases, named(where.c_str(), Kind::hard), what + " against images", [=] {
        return dipole(disk(Kind::hard, 1e-4), gap, -1, across, gap < 1e-3 ? 1e-4 : 1e-9,
                      gap < 1e-3 ? 1e-4 : 1e-6);
      });
    }
  }
  for (const bool across : {false, true})
    add(cases, "TE, k a 1e-4, gap 1e-6",
        across ? "dipole across the axis against images" : "dipole along the axis against images",
        [=] {
          const double reflection = -(1.5 * 1.5 - 1) / (1.5 * 1.5 + 1);
          return dipole(disk(Kind::te, 1e-4), 1e-6, reflection, across, 1e-9, 1e-6);
        });
}

void add_sizes(Cases& cases) {
  for (const Kind kind : {Kind::soft, Kind::hard, Kind::tm, Kind::te}) {
    add(cases, named("k a 1e-4, gap 0.5", kind), "light and view exchanged",
        [=] { return reciprocity(pair(disk(kind, 1e-4), 0.5), 1e-12); });
    add(cases, named("k a 100, gap 0.5", kind), "energy",
        [=] { return energy(pair(disk(kind, 100), 0.5), 2000, 1e-11); });
    add(cases, named("k a 100, gap 0.5", kind), "far field at 1e-6 against 1e-12",
        [=] { return convergence(pair(disk(kind, 100), 0.5), 1e-6, 1e-12); });
  }
  add(cases, "soft, k a 1e-4, gap 2000", "two coupled monopoles",
      [] { return monopoles(disk(Kind::soft, 1e-4), 1e-6); });
  add(cases, "TM, k a 1e-4, gap 2000", "two coupled monopoles",
      [] { return monopoles(disk(Kind::tm, 1e-4), 1e-6); });
  for (const Kind kind : {Kind::tm, Kind::te}) {
    for (const double x : {1e-4, 1.0, 100.0})
      add(cases,
          named(x < 1   ? "k a 1e-4, index 1 + 1e-8"
                : x > 1 ? "k a 100, index 1 + 1e-8"
                        : "k a 1, index 1 + 1e-8",
                kind),
          "independent scattering",
          [=] { return independent(disk(kind, x, 1 + 1e-8), x > 1 ? 1e-5 : 1e-7); });
    add(cases, named("k a 1000, index 0.1 + 5i", kind), "Mie series from J'/J of the textbook",
        [=] {
          return mie(disk(kind, 1000, {0.1, 5}), 1e-9);
        });
    add(cases, named("k a 100, index 10", kind), "Mie series from J'/J of the textbook",
        [=] { return mie(disk(kind, 100, 10), 1e-9); });
    for (const double x : {1e-4, 1.0, 10.0})
      add(cases,
          named(x < 1   ? "k a 1e-4, index 0.1 + 5i, gap 0.1"
                : x > 1 ? "k a 10, index 0.1 + 5i, gap 0.1"
                        : "k a 1, index 0.1 + 5i, gap 0.1",
                kind),
          "far field at 1e-6 against 1e-12", [=] {
            return convergence(pair(disk(kind, x, {0.1, 5}), 0.1), 1e-6, 1e-12);
          });
    for (const double x : {1e-4, 1.0, 10.0})
      add(cases,
          named(x < 1   ? "k a 1e-4, index 10, gap 0.1"
                : x > 1 ? "k a 10, index 10, gap 0.1"
                        : "k a 1, index 10, gap 0.1",
                kind),
          "far field at 1e-6 against 1e-12",
          [=] { return convergence(pair(disk(kind, x, 10), 0.1), 1e-6, 1e-12); });
  }
}

void add_resonances(Cases& cases) {
  const auto two = [] { return pair(disk(Kind::tm, resonance(5, 0.7, 0.95), 10), 0.05); };
  add(cases, "TM, index 10, two disks at a resonance of n = 5", "energy",
      [=] { return energy(two(), 64, 1e-9); });
  add(cases, "TM, index 10, two disks at a resonance of n = 5", "far field at 1e-6 against 1e-12",
      [=] { return convergence(two(), 1e-6, 1e-12); });
}

void add_counts(Cases& cases) {
  add(cases, "no scatterer", "no field", [] {
    const auto solution = solved({}, 1e-12, true);
    return Finding{std::abs(solution.far_field(1)) + solution.diagnosis().residual, 0, {}};
  });
  add(cases, "one resonant point", "amplitude 4/k = its cross-section", [] {
    const double amplitude = std::abs(solved({{{1, 2}, Scatterer{}}}, 1e-12).far_field(1));
    return Finding{std::abs(2 * pi * amplitude * amplitude * k / 4 - 1), 1e-14, {}};
  });
  const Scatterer one = disk(Kind::tm, 1);
  for (const double d : {0.0, 0.5 * one.radius, 2 * one.radius})
    add(
        cases,
        d == 0           ? "one disk upon another"
        : d < one.radius ? "overlapping disks"
                         : "touching disks",
        "refused",
        [=] {
          return convergence({{{0, 0}, one}, {{0, d}, one}}, 1e-6, 1e-9);
        },
        "overlap");
  add(
      cases, "one point upon another", "refused",
      [] {
        return convergence({{{0, 0}, Scatterer{}}, {{0, 0}, Scatterer{}}}, 1e-6, 1e-9);
      },
      "overlap");
}

}  // namespace

std::vector<ExtremeCase> extreme_cases() {
  Cases cases;
  add_gaps(cases);
  add_sizes(cases);
  add_resonances(cases);
  add_counts(cases);
  return cases;
}

std::vector<ExtremeCase> large_cases() {
  Cases cases;
  add(cases, "1e5 points, phase shift 0.05, GMRES to 1e-6", "light and view exchanged", [] {
    const auto solution =
        solve(many_points(100'000, 330, 0.05), k, lights,
              {.tolerance = 1e-6, .sensors = {}, .diagnose = false, .method = Method::krylov});
    const Complex there = solution.far_field(lights[1] - pi, 0),
                  back = solution.far_field(lights[0] + pi, 1);
    return Finding{std::abs(there - back) / std::abs(there), 1e-5, {}};
  });
  return cases;
}

Finding examine(const ExtremeCase& extreme) {
  try {
    return extreme.run();
  } catch (const InputError& error) {
    return {0, 0, error.what()};
  }
}

bool passes(const ExtremeCase& extreme, const Finding& finding) {
  if (!extreme.must_say.empty()) return finding.refusal.find(extreme.must_say) != std::string::npos;
  return finding.refusal.empty() && finding.figure <= finding.limit;
}

}  // namespace flatspeckle::wave

#include "bench/stability/wave_extremes.h"

#include <cmath>
#include <math.h>  // jn and yn are POSIX
#include <string>
#include <utility>

#include "core/numbers/random.h"
#include "wave_solver/periodic/scattering_matrix.h"

namespace flatspeckle::bench {

Finding reciprocity(const Placement& placement, const SolveOptions& options, double limit) {
  const auto solution = solve(placement, k, two_lights, options);
  return off(solution.far_field(two_lights[0] + pi, 1), solution.far_field(two_lights[1] - pi, 0),
             limit);
}

std::vector<View> views_around() {
  std::vector<View> views;
  for (int i = 0; i < 36; ++i) views.push_back(far_view(2 * pi * i / 36));
  return views;
}

Complex far_amplitude(Complex sum) {
  return std::polar(std::sqrt(2 / (pi * k)), -pi / 4) * sum;
}

namespace {

// Two equal disks with the origin midway between them; the gap is in radii. The axis is oblique,
// because along x or z some components of the translation vanish.
Placement pair(const Scatterer& scatterer, double gap, double axis = 0.7) {
  const Vec half = (1 + gap / 2) * scatterer.radius * direction(axis);
  return {{-half, scatterer}, {half, scatterer}};
}

WaveSolution solved(const Placement& placement, double tolerance) {
  return solve(placement, k, two_lights, to(tolerance));
}

// Compares far fields at two tolerances, which have different basis orders.
Finding convergence(const Placement& placement, double tolerance, double finer) {
  const auto views = views_around();
  return {relative_difference(solved(placement, tolerance).fields(views),
                              solved(placement, finer).fields(views)),
          tolerance};
}

// Compares scattered power with extinction (C9). Only for lossless disks.
Finding energy(const Placement& placement, int views, double limit) {
  const auto solution = solved(placement, 1e-12);
  double scattered = 0;
  for (int i = 0; i < views; ++i)
    scattered += std::norm(solution.far_field(2 * pi * i / views)) * 2 * pi / views;
  const Complex forward = solution.far_field(two_lights[0]) * std::polar(1.0, pi / 4);
  const double lost = -std::sqrt(8 * pi / k) * forward.real();
  return {std::abs(scattered / lost - 1), limit};
}

Finding boundary(const Placement& placement, double tolerance, double limit) {
  SolveOptions options = to(tolerance);
  options.diagnose = true;
  return {solve(placement, k, two_lights, options).diagnosis().boundary_residual, limit};
}

// Returns T_n by the formula of C7, with the C library's J and Y and with D_n = J_n'/J_n at z = m
// x. D_n is from downward recurrence of D_n = -n/z + 1 / ((n-1)/z - D_{n-1}).
Complex textbook_t(const Scatterer& cylinder, int n) {
  const double x = k * cylinder.radius;
  const Complex mx = cylinder.index * x,
                q = cylinder.kind == Kind::tm ? cylinder.index : 1.0 / cylinder.index;
  const int start = n + 60 + static_cast<int>(1.2 * std::abs(mx));
  Complex d = 0;
  for (int m = start; m > n; --m)
    d = static_cast<double>(m - 1) / mx - 1.0 / (static_cast<double>(m) / mx + d);
  const double j = ::jn(n, x), j_derivative = n / x * j - ::jn(n + 1, x), y = ::yn(n, x);
  const Complex h(j, y), h_derivative(j_derivative, n / x * y - ::yn(n + 1, x));
  return -(q * d * j - j_derivative) / (q * d * h - h_derivative);
}

Finding mie(const Scatterer& cylinder, double limit) {
  const double x = k * cylinder.radius, view = 2.0;
  Complex sum = textbook_t(cylinder, 0);
  for (int n = 1; n < x + 15 * std::cbrt(x) + 15; ++n)
    sum += 2.0 * textbook_t(cylinder, n) * std::cos(n * (view - two_lights[0]));
  return off(solved({{{0, 0}, cylinder}}, 1e-14).far_field(view), far_amplitude(sum), limit);
}

// Returns the electrostatic dipole moment of a pair of disks divided by that of two isolated disks.
// It is the sum over images n of R^n (sinh xi / sinh (n + 1) xi)^2, where cosh xi = d / 2a
// (distance d, radius a) and R is the strength of one image reflection.
Complex image_sum(double gap, Complex reflection) {
  const double xi =
      2 * std::asinh(std::sqrt(gap) / 2);  // this form avoids cancellation at small gaps
  Complex sum = 0, power = 1;
  for (int n = 0; n < 1 || n * xi < 20; ++n) {
    const double ratio = std::sinh(xi) / std::sinh((n + 1) * xi);
    sum += power * ratio * ratio;
    if (std::abs(power) * ratio * ratio < 1e-17) break;
    power *= reflection;
  }
  return sum;
}

// Compares a pair of small disks, illuminated and viewed along its axis or across it, with the sum
// over images. reflection: strength of one image reflection along the axis.
Finding dipole(const Scatterer& small, double gap, Complex reflection, bool across,
               double tolerance, double limit) {
  const double angle = across ? pi / 2 : 0;
  const auto moment = [&](const Placement& placement) {
    const auto solution = solve(placement, k, {angle}, to(tolerance));
    return solution.far_field(angle) - solution.far_field(angle + pi);
  };
  const Complex found = moment(pair(small, gap, 0)) / (2.0 * moment({{{0, 0}, small}}));
  return off(found, image_sum(gap, across ? -reflection : reflection), limit);
}

// Compares with two coupled monopoles, b = T_0 (a + H_0(kd) b), illuminated across the axis.
Finding monopoles(const Scatterer& small, double limit) {
  const Placement two = pair(small, 2000, 0);
  const double kd = k * length(two[1].position - two[0].position);
  const Complex t = static_cast<Complex>(t_matrix(small, k, 0)[0]);
  const Complex b = t / (1.0 - t * Complex(::j0(kd), ::y0(kd)));
  const auto solution = solve(two, k, {pi / 2}, to(1e-12));
  return off(solution.far_field(pi / 2), far_amplitude(2.0 * b), limit);
}

// Checks that almost invisible disks scatter independently.
Finding independent(const Scatterer& faint, double limit) {
  const Placement two = pair(faint, 0.5);
  const auto solution = solved(two, 1e-12), single = solved({{{0, 0}, faint}}, 1e-12);
  std::vector<Complex> found, expected;
  for (const View& view : views_around()) {
    found.push_back(solution.far_field(view.angle));
    Complex phases = 0;
    for (const auto& [position, scatterer] : two)
      phases +=
          std::polar(1.0, k * dot(direction(two_lights[0]) - direction(view.angle), position));
    expected.push_back(single.far_field(view.angle) * phases);
  }
  return {relative_difference(found, expected), limit};
}

// Returns the size parameter in [low, high] at which order n of a disk of index 10 resonates, T_n =
// -1.
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

std::string named(const std::string& what, Kind kind) {
  const char* names[] = {"point", "soft", "hard", "TM", "TE"};
  return std::string(names[static_cast<int>(kind)]) + ", " + what;
}

constexpr Kind all_disks[] = {Kind::soft, Kind::hard, Kind::tm, Kind::te};
const std::string far_at_1e6 = "far field at 1e-6 against 1e-12";

void add_gaps(ExtremeRows& rows) {
  for (const Kind kind : all_disks) {
    const Placement near = pair(disk(kind, 1), 1e-3), nearer = pair(disk(kind, 1), 1e-6);
    rows.add(named("k a 1, gap 1e-3", kind), "far field at 1e-6 against 1e-9", convergence, near,
             1e-6, 1e-9);
    rows.add_slow(named("k a 1, gap 1e-3", kind), "boundary residual", boundary, near, 1e-9, 1e-3);
    if (kind != Kind::hard)
      rows.add(named("k a 1, gap 1e-6", kind), "far field at 1e-9 against 1e-12", convergence,
               nearer, 1e-9, 1e-12);
  }
  for (const double ka : {0.01, 1.0, 10.0})
    // the order is about 7.0e3 = ln(1e6) / (2 xi) with xi = 1e-3; the gap is rounded down
    rows.add_refused("hard, k a " + short_number(ka) + ", gap 1e-6", "basis order 70", boundary,
                     pair(disk(Kind::hard, ka), 1e-6), 1e-6, 0);
}

void add_statics(ExtremeRows& rows) {
  for (const bool across : {false, true}) {
    const std::string what =
        across ? "dipole across the axis against images" : "dipole along the axis against images";
    for (const double gap : {1e-2, 1e-4}) {
      // small gaps need very high orders, so the tolerance is relaxed
      const double tolerance = gap < 1e-3 ? 1e-4 : 1e-9, limit = gap < 1e-3 ? 1e-4 : 1e-6;
      rows.add_timed(gap < 1e-3, "hard, k a 1e-4, gap " + short_number(gap), what, dipole,
                     disk(Kind::hard, 1e-4), gap, -1, across, tolerance, limit);
    }
    const double te = -(1.5 * 1.5 - 1) / (1.5 * 1.5 + 1);
    rows.add("TE, k a 1e-4, gap 1e-6", what, dipole, disk(Kind::te, 1e-4), 1e-6, te, across, 1e-9,
             1e-6);
  }
  for (const Kind kind : {Kind::soft, Kind::tm})
    rows.add(named("k a 1e-4, gap 2000", kind), "two coupled monopoles", monopoles,
             disk(kind, 1e-4), 1e-6);
}

void add_sizes(ExtremeRows& rows) {
  for (const Kind kind : all_disks) {
    const Placement small = pair(disk(kind, 1e-4), 0.5), large = pair(disk(kind, 100), 0.5);
    rows.add(named("k a 1e-4, gap 0.5", kind), "light and view exchanged", reciprocity, small,
             to(1e-12), 1e-12);
    rows.add(named("k a 100, gap 0.5", kind), "energy", energy, large, 2000, 1e-11);
    rows.add(named("k a 100, gap 0.5", kind), far_at_1e6, convergence, large, 1e-6, 1e-12);
  }
}

void add_indices(ExtremeRows& rows) {
  const Complex metal(0.1, 5);
  for (const Kind kind : {Kind::tm, Kind::te}) {
    for (const double x : {1e-4, 1.0, 100.0})
      // the neglected double scattering is as large as the phase shift by one disk, 2 k a 1e-8
      rows.add(named("k a " + short_number(x) + ", index 1 + 1e-8", kind), "independent scattering",
               independent, disk(kind, x, 1 + 1e-8), x > 1 ? 1e-5 : 1e-7);
    const std::string textbook = "Mie series from J'/J of the textbook";
    rows.add_slow(named("k a 1000, index 0.1 + 5i", kind), textbook, mie, disk(kind, 1000, metal),
                  1e-9);
    rows.add(named("k a 100, index 10", kind), textbook, mie, disk(kind, 100, 10), 1e-9);
    for (const double x : {1e-4, 1.0, 10.0}) {
      for (const auto& [name, index] : {std::pair("0.1 + 5i", metal), {"10", 10}})
        rows.add(named("k a " + short_number(x) + ", index " + name + ", gap 0.1", kind),
                 far_at_1e6, convergence, pair(disk(kind, x, index), 0.1), 1e-6, 1e-12);
    }
  }
}

// Adds pairs of metal disks with gap plasmons, which need other orders than dielectric pairs.
void add_gap_plasmons(ExtremeRows& rows) {
  for (const auto& [gap, index] : {std::pair(0.02, Complex(0.05, 2.2)), {0.002, {0.05, 2.2}}})
    rows.add_slow("TE, k a 0.6, index 0.05 + 2.2i, gap " + short_number(gap),
                  "far field at 1e-4 against 1e-6", convergence,
                  pair(disk(Kind::te, 0.6, index), gap), 1e-4, 1e-6);
}

void add_resonances(ExtremeRows& rows) {
  const auto two = [] { return pair(disk(Kind::tm, resonance(5, 0.7, 0.95), 10), 0.05); };
  const std::string name = "TM, index 10, two disks at a resonance of n = 5";
  rows.add(name, "energy", [=] { return energy(two(), 64, 1e-9); });
  rows.add(name, far_at_1e6, [=] { return convergence(two(), 1e-6, 1e-12); });
}

void add_overlaps(ExtremeRows& rows) {
  const Scatterer one = disk(Kind::tm, 1);
  for (const auto& [name, distance] : {std::pair("one disk upon another", 0.0),
                                       {"overlapping disks", 0.5},
                                       {"touching disks", 2.0}})
    rows.add_refused(name, "overlap", [=, z = distance * one.radius] {
      solved({{{0, 0}, one}, {{0, z}, one}}, 1e-6);
    });
  rows.add_refused("one point upon another", "overlap", [] {
    solved({{{0, 0}, Scatterer{}}, {{0, 0}, Scatterer{}}}, 1e-6);
  });
}

Finding cell_power(const Placement& placement, double width, double phase, double limit) {
  const auto found = scattering_matrix(placement, k, {width, phase}, to(1e-11, Method::fast));
  return {found.power.off, limit};
}

Placement deep_points(int count) {
  RandomStream random(1, 0, 0);
  Placement points;
  for (int i = 0; i < count; ++i)
    points.push_back({{1.3 * random.uniform(), i + random.uniform()}, Scatterer{}});
  return points;
}

void add_cells(ExtremeRows& rows) {
  const std::string unitary = "unitarity";
  const Placement row{{{0, 0}, disk(Kind::te, 1, 1.5)}};
  for (const double beside : {0.0, 1e-12, 1e-6})
    rows.add("row of TE disks, " + short_number(beside) + " beside a Wood anomaly", unitary,
             cell_power, row, 2 * (1 + beside), 0, 1e-10);
  for (const Kind kind : {Kind::soft, Kind::tm})
    rows.add(named("gap 1e-3 to the next period", kind), unitary, cell_power,
             Placement{{{0, 0}, disk(kind, 2)}}, (2 + 1e-3) * disk(kind, 2).radius, 0.3, 1e-9);
  rows.add("row of TM disks, k period 1000", unitary, cell_power,
           Placement{{{0, 0}, disk(Kind::tm, 1)}}, 1000 / k, 0.3, 1e-9);
  rows.add("points, 50 periods deep", unitary, cell_power, deep_points(65), 1.3, 0.3, 1e-9);
  rows.add_refused("disk wider than the period", "overlap with those of the next period",
                   [=] { cell_power(row, 1.9 / k, 0, 1); });
}

}  // namespace

void wave_extremes(ExtremeRows& rows) {
  add_cells(rows);
  add_gaps(rows);
  add_statics(rows);
  add_sizes(rows);
  add_indices(rows);
  add_gap_plasmons(rows);
  add_resonances(rows);
  add_overlaps(rows);
}

}  // namespace flatspeckle::bench

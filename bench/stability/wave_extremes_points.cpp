// Point scatterers that are very close, very far apart or very many; fields next to boundaries;
// units of length; rejected inputs.

#include <cmath>
#include <tuple>

#include "bench/scenes/copied_cluster.h"
#include "bench/stability/wave_extremes.h"
#include "core/numbers/bessel.h"
#include "core/numbers/random.h"
#include "wave_solver/clusters/cluster_solution.h"
#include "wave_solver/solutions/ensemble.h"
#include "wave_solver/sums/helmholtz_sum.h"

namespace flatspeckle::bench {

namespace {

Placement many_points(std::size_t count, double width, double phase_shift) {
  const Scatterer point{.phase_shift = phase_shift};
  RandomStream random(1, 0, 0);
  Placement points;
  while (points.size() < count) {
    const double x = random.uniform(), z = random.uniform();
    points.push_back({{width * x, width * z}, point});
  }
  return points;
}

/// Compares two resonant points at distance kd, illuminated across or along their axis, with the
/// closed form in extended precision: b = T (a + H b), solved for sum and difference of the
/// amplitudes.
Finding two_points(double kd, double light, double view, double limit) {
  const double half = kd / (2 * k);
  const auto solution =
      solve({{{0, -half}, Scatterer{}}, {{0, half}, Scatterer{}}}, k, {light}, to(1e-12));
  using Real = long double;
  const ExtendedComplex h = hankel(0, k * (2 * half))[0], t = -1;
  const auto phase = [&](double angle) { return static_cast<Real>(k) * half * std::cos(angle); };
  const Real in = phase(light), out = phase(view);
  const ExtendedComplex even = t * std::cos(in) / (Real{1} - t * h),
                        odd = t * ExtendedComplex(0, std::sin(in)) / (Real{1} + t * h);
  const ExtendedComplex sum =
      Real{2} * (even * std::cos(out) - odd * ExtendedComplex(0, std::sin(out)));
  return off(solution.far_field(view), far_amplitude(Complex(sum)), limit);
}

Placement three_disks(double unit) {
  const Scatterer one{.kind = Kind::tm, .radius = 0.2 * unit};
  return {{{0, 0}, one}, {{0.1 * unit, 0.45 * unit}, one}, {{-0.5 * unit, 0.1 * unit}, one}};
}

/// Checks that far fields scale correctly with the unit of length: |A|^2 is a length.
Finding unit_of_length(double unit) {
  const auto here = solve(three_disks(1), k, two_lights, to(1e-12));
  const auto there = solve(three_disks(unit), k / unit, two_lights, to(1e-12));
  return worst_of({0.0, 1.1, 2.9}, 1e-11, [&](double view) {
    return std::abs(there.far_field(view) / (std::sqrt(unit) * here.far_field(view)) - 1.0);
  });
}

/// Checks u = 0 on the boundary: at a distance of 1e-9 radii, the field is that distance times the
/// normal derivative, about 2 k.
Finding soft_rim() {
  const Scatterer one = disk(Kind::soft, 5);
  const Placement placement{{{0, 0}, one}, {{2 * one.radius, 2 * one.radius}, one}};
  double worst = 0;
  std::vector<Vec> sensors;
  for (const double angle : {0.0, 1.3, 3.0})
    sensors.push_back((1 + 1e-9) * one.radius * direction(angle));
  auto options = to(1e-10);
  options.sensors = sensors;
  const auto solution = solve(placement, k, {0.3}, options);
  for (const Vec sensor : sensors) {
    const Complex incident = std::polar(1.0, k * dot(direction(0.3), sensor));
    worst = larger(worst, std::abs(solution.near_field(sensor) + incident));
  }
  return {worst, 1e-7};
}

/// Checks sums over charges in clusters that are 1e-7 wavelengths wide and 300 wavelengths apart.
Finding clustered_sum() {
  RandomStream random(2, 0, 0);
  std::vector<Vec> points;
  std::vector<Complex> charges;
  for (int cluster = 0; cluster < 40; ++cluster) {
    const Vec centre{300 * random.uniform(), 300 * random.uniform()};
    for (int i = 0; i < 50; ++i) {
      points.push_back(centre + 1e-7 * Vec{random.uniform(), random.uniform()});
      charges.push_back({random.uniform() - 0.5, random.uniform() - 0.5});
    }
  }
  const auto found = HelmholtzSum(k, points, 1e-10)(charges);
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < points.size(); i += 37) {
    ExtendedComplex sum = 0;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i)
        sum += hankel(0, k * length(points[i] - points[j]))[0] * ExtendedComplex(charges[j]);
    difference += std::norm(found[i] - Complex(sum));
    size += std::norm(Complex(sum));
  }
  return {std::sqrt(difference / size), 1e-10};
}

// Four disks about the origin, within a circle of 3 radii.
constexpr double tolerance = 1e-9;
Placement four_disks(double radius, Complex index) {
  const Scatterer disk{.kind = Scatterer::Kind::tm, .radius = radius, .index = index};
  const double out = 2 * radius;
  return {{{out, 0}, disk}, {{0, out}, disk}, {{-out, 0}, disk}, {{0, -0.9 * out}, disk}};
}

// Compares two copies of the four disks, treated by their cluster's T-matrix, with all eight disks
// in one system. The gap between the circles around the copies is in radii of these circles.
Finding against_all_disks(double radius, Complex index, double gap, double limit) {
  const Placement disks = four_disks(radius, index);
  const auto cluster = cluster_t_matrix(disks, k, gap * 3 * radius, tolerance);
  const auto places = rows_of_places(1, 2, 2 * cluster.radius + 1.01 * cluster.gap);
  const std::vector<double> lights{0.3, 1.9};
  const std::vector<View> views = views_around();
  const SolveOptions options = to(tolerance);
  const auto whole = solve(copies(disks, places), k, two_lights, options).fields(views);
  const auto found = ClusterSolution(cluster, places, two_lights, options).fields(views);
  return {relative_difference(found, whole), limit};
}

void add_clusters(ExtremeRows& rows) {
  for (const auto& [name, ka, index, gap] : {std::tuple("k a 1e-3", 1e-3, Complex(1.5), 0.5),
                                             {"k a 1", 1, 1.5, 0.5},
                                             {"k a 10", 10, 1.5, 0.5},
                                             {"k a 1, gap of 0.1 radii", 1, 1.5, 0.1},
                                             {"k a 1, index 10", 1, 10, 0.5},
                                             {"k a 1, index 1 + 1e-8", 1, 1 + 1e-8, 0.5},
                                             {"k a 1, index 0.1 + 5i", 1, {0.1, 5}, 0.5}})
    rows.add("two copies of a cluster, disks of " + std::string(name), "all disks in one",
             against_all_disks, ka / k, index, gap, 1e-7);
  rows.add_refused("copies closer than the gap of their T-matrix", "gap", [] {
    const auto cluster = cluster_t_matrix(four_disks(1 / k, 1.5), k, 0.5, tolerance);
    ClusterSolution(cluster, rows_of_places(1, 2, 2 * cluster.radius), {0});
  });
}

void add_points(ExtremeRows& rows) {
  for (const double kd : {1e-12, 1e-6, 1.0, 1e6})
    for (const auto& [where, light] : {std::pair("along", 0.0), {"across", pi / 2}})
      // rounding changes phases of 1e6 by 1e-10
      rows.add("two resonant points, k d " + short_number(kd) + ", light " + where + " the axis",
               "closed form in extended precision",
               [=, light = light] { return two_points(kd, light, 2.0, kd > 1e3 ? 1e-9 : 1e-12); });
  rows.add("no scatterer", "no field", [] {
    const auto solution = solve({}, k, two_lights, {});
    return Finding{std::abs(solution.far_field(1)) + solution.diagnosis().residual, 0};
  });
  rows.add("one resonant point", "cross-section 4/k", [] {
    const double amplitude = std::abs(solve({{{1, 2}, Scatterer{}}}, k, two_lights).far_field(1));
    return Finding{std::abs(2 * pi * amplitude * amplitude * k / 4 - 1), 1e-14};
  });
  rows.add("500 resonant points in a box of 3 wavelengths", "light and view exchanged",
           [] { return reciprocity(many_points(500, 3, pi / 2), to(1e-12), 1e-9); });
  rows.add(
      "500 resonant points in a box of 3 wavelengths, by GMRES alone", "light and view exchanged",
      [] { return reciprocity(many_points(500, 3, pi / 2), to(1e-10, Method::krylov), 1e-7); });
  rows.add_slow("1e5 points, phase shift 0.05, GMRES to 1e-6", "light and view exchanged", [] {
    return reciprocity(many_points(100'000, 330, 0.05), to(1e-6, Method::krylov), 1e-5);
  });
}

void add_point_fields(ExtremeRows& rows) {
  rows.add_each("three TM disks in a unit of length of ", {1e-9, 1e9}, "", "far field scales",
                unit_of_length);
  rows.add("two soft disks, 1e-9 radii from a rim", "the field there, of 1", soft_rim);
  rows.add("H_0 sum over clusters of 1e-7 wavelengths, 300 apart", "pair by pair, long double",
           clustered_sum);
}

void add_point_refusals(ExtremeRows& rows) {
  const Scatterer one{.kind = Kind::tm, .radius = 0.2};
  rows.add_refused("sensor within a disk", "outside every scatterer", [=] {
    auto options = to(1e-6);
    options.sensors = {{0.1, 0}};
    solve({{{0, 0}, one}}, k, {0}, options).near_field({0.1, 0});
  });
  rows.add_refused("disk of k a 1e5", "at most 10000", [] {
    solve({{{0, 0}, disk(Kind::tm, 1e5)}}, k, {0}, to(1e-6));
  });
  rows.add_refused("3e5 points by a dense matrix", "1440000000000 bytes",
                   [] { solve(many_points(300'000, 1000, 1), k, {0}, to(1e-6, Method::dense)); });
  SceneSpec bulk;
  bulk.scatterer = "hg";
  bulk.depth = 10;
  bulk.optical_depth = 1;
  rows.add_refused("a bulk phase function for the exact solver", "hg", [=] {
    SceneSpec box = bulk;
    box.width = 10;
    wave_job(make_scene(box), 1, 1e-6);
  });
  rows.add_refused("an infinite slab for the exact solver", "slab", [=] {
    SceneSpec slab = bulk;
    slab.domain = "slab";
    slab.scatterer = "point";
    wave_job(make_scene(slab), 1, 1e-6);
  });
}

}  // namespace

void wave_point_extremes(ExtremeRows& rows) {
  add_points(rows);
  add_point_fields(rows);
  add_point_refusals(rows);
  add_clusters(rows);
}

}  // namespace flatspeckle::bench

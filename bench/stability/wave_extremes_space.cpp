// Exact waves in space: points and spheres that are very close, very small, large, strongly
// refracting or absorbing; one scatterer, none, and scatterers on top of each other.

#include <cmath>
#include <string>
#include <vector>

#include "bench/stability/wave_extremes.h"
#include "wave_solver/solutions/space_solution.h"

namespace flatspeckle::bench {

namespace {

/// Lights and views out of any common plane.
Lights oblique_lights() {
  return Lights{plane_wave(0.4, 1), plane_wave(2.1, -2)};
}
std::vector<View> oblique_views() {
  return {far_view(0.4, 1), far_view(1.3, 2), far_view(2.8, -0.5), far_view(pi / 2, 4)};
}

/// Compares two resonant points at distance k d with the closed form in extended precision:
/// psi = u + f psi' exp(i k d)/d, solved for sum and difference.
Finding two_points_in_space(double kd) {
  const double half = kd / (2 * k);
  const Lights lights = oblique_lights();
  const auto solution =
      solve_in_space({{{0, -half}, Scatterer{}}, {{0, half}, Scatterer{}}}, k, lights, to(1e-12));
  const auto views = oblique_views();
  const auto found = solution.fields(views);
  using Real = long double;
  const Real size = kd;
  const ExtendedComplex f(0, 1), wave = std::polar(Real{1} / size, size);  // in units of 1/k
  double worst = 0;
  for (std::size_t i = 0; i < lights.size(); ++i)
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Real in = size / 2 * static_cast<Real>(lights[i].direction().z),
                 out = size / 2 * static_cast<Real>(views[v].direction().z);
      const ExtendedComplex even = std::cos(in) / (Real{1} - f * wave),
                            odd = ExtendedComplex(0, std::sin(in)) / (Real{1} + f * wave);
      const ExtendedComplex sum =
          f * Real{2} * (even * std::cos(out) - odd * ExtendedComplex(0, std::sin(out)));
      const Complex expected(static_cast<double>(sum.real()), static_cast<double>(sum.imag()));
      worst = larger(worst, std::abs(k * found[i * views.size() + v] - expected));
    }
  return {worst, 1e-9};
}

Placement pair_of(const Scatterer& first, const Scatterer& second, double gap) {
  const double apart = first.radius + second.radius + gap;
  return {{{0, 0.3}, first}, {{apart * 0.6, 0.3 + apart * 0.8, 0}, second}};
}

/// Compares the fields of two spheres with a gap, in units of the radius, at the tolerances 1e-3
/// and 1e-6. The balance of power must hold at both.
Finding narrow_gap(Kind kind, double gap) {
  const Scatterer sphere{.kind = kind, .radius = 1 / k, .index = 1.5};
  const auto fields_to = [&](double tolerance) {
    const auto solution = solve_in_space(pair_of(sphere, sphere, gap * sphere.radius), k,
                                         oblique_lights(), {.tolerance = tolerance, .sensors = {}});
    if (!solution.diagnosis().power.holds()) return std::vector<Complex>();
    return solution.fields(oblique_views());
  };
  const auto found = fields_to(1e-3), expected = fields_to(1e-6);
  if (found.empty() || expected.empty()) return {1, 0};
  return {relative_difference(found, expected), 1e-2};
}

/// Compares one sphere with its amplitude.
Finding one_sphere(double size, Complex index) {
  const Scatterer sphere{.kind = Kind::tm, .radius = size / k, .index = index};
  const Lights lights = oblique_lights();
  const auto views = oblique_views();
  const auto found = solve_in_space({{{0, 0}, sphere}}, k, lights, to(1e-12)).fields(views);
  const auto t =
      t_matrix(sphere, k, isolated_order(sphere, k, 1e-16, Radial::spherical), Radial::spherical);
  const double forward = std::abs(amplitude_in_space(t, k, 1));
  double worst = 0;
  for (std::size_t i = 0; i < lights.size(); ++i)
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Complex expected =
          amplitude_in_space(t, k, dot(lights[i].direction(), views[v].direction()));
      worst = larger(worst, std::abs(found[i * views.size() + v] - expected) / forward);
    }
  return {worst, 1e-9};
}

/// Checks that no scatterers give no field.
Finding no_scatterers() {
  double sum = 0;
  for (const Complex value : solve_in_space({}, k, oblique_lights()).fields(oblique_views()))
    sum += std::abs(value);
  return {sum, 0};
}

/// Checks reciprocity of a point, a soft and a penetrable sphere: lights and views exchanged.
Finding exchanged_in_space() {
  const Placement mixed{{{0, 0}, Scatterer{}},
                        {{0.5, 0.2, 0.1}, {.kind = Kind::soft, .radius = 0.1}},
                        {{-0.2, 0.6, 0.4}, {.kind = Kind::tm, .radius = 0.2, .index = {2, 0.1}}}};
  const flatspeckle::Light light = plane_wave(0.4, 1);
  const View view = far_view(2.5, -2);
  const flatspeckle::Light back = plane_wave(pi - view.angle, view.azimuth + pi);
  const View to_light = far_view(pi - light.angle, light.azimuth + pi);
  const Complex there = solve_in_space(mixed, k, Lights{light}, to(1e-12)).fields({&view, 1})[0],
                here = solve_in_space(mixed, k, Lights{back}, to(1e-12)).fields({&to_light, 1})[0];
  return off(there, here, 1e-10);
}

}  // namespace

void wave_space_extremes(ExtremeRows& rows) {
  rows.add_each("two points in space, k d ", {1e-6, 1e-3, 1.0, 1e3, 1e6}, "", "closed form",
                two_points_in_space);
  for (const auto& [name, kind] : {std::pair{"soft", Kind::soft}, {"penetrable", Kind::tm}})
    for (const double gap : {0.1, 1e-2})
      rows.add(std::string("two ") + name + " spheres, gap " + short_number(gap),
               "a smaller tolerance", narrow_gap, kind, gap);
  rows.add("two hard spheres, gap 0.1", "a smaller tolerance", narrow_gap, Kind::hard, 0.1);
  rows.add_refused("two hard spheres, gap 1e-6", "gap", narrow_gap, Kind::hard, 1e-6);
  rows.add_refused("spheres on top of each other", "overlap", narrow_gap, Kind::soft, -0.5);
  for (const double size : {1e-4, 1.0, 20.0})
    for (const Complex index : {Complex(1.33), Complex(10), Complex(0.1, 5)})
      rows.add("one sphere of k a " + short_number(size) + ", index " + short_number(index.real()) +
                   (index.imag() == 0 ? "" : " + " + short_number(index.imag()) + "i"),
               "its amplitude", one_sphere, size, index);
  rows.add("no scatterers in space", "no field", no_scatterers);
  rows.add("point, soft and absorbing sphere", "light and view exchanged", exchanged_in_space);
}

}  // namespace flatspeckle::bench

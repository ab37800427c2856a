// Speckle in space: boxes that are needles, sheets or specks; lights and views at any azimuth,
// along the axis and grazing; sensors on faces, edges and inside; the sphere's amplitudes.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "bench/stability/extreme_rows.h"
#include "bench/stability/mc_extremes.h"
#include "mc/paths/endpoint_factors/coherent_field.h"
#include "mc/paths/endpoint_factors/space_scattering.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::bench {

namespace {

using mc::ReversedPaths;
using std::numbers::pi;

/// A box in space; depth and optical depth along z are those of the Bulk.
Scene space_box(double width, double height, const Bulk& bulk, const CovarianceRequest& request) {
  Scene scene = hg_box(width, bulk, request);
  scene.domain.height = height;
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = bulk.g;
  scene = mc::in_space(std::move(scene), spec);
  scene.request = request;
  return scene;
}

/// Checks a tiny box, in which only single scattering matters: mu_s times the phase function times
/// the volume.
Finding speck_in_space() {
  const double size = 1e-6, g = 0.5;
  const auto request =
      intensity_request(flatspeckle::Lights{plane_wave(0), plane_wave(1, 2)},
                        {far_view(0.3, 0.4), far_view(pi / 2, pi / 2), far_view(2, -1)});
  const Scene scene = space_box(size, size, {size, g, 1, size}, request);
  const Estimate found = covariance(scene, ReversedPaths::no, 4000);
  const grin::HenyeyGreenstein<3> phase{g};
  double worst = 0;
  for (std::size_t c = 0; c < request.channels.size(); ++c) {
    const auto [light, view] = request.channels[c];
    const double p =
        phase.density_at(dot(request.lights[light].direction(), request.views[view].direction()));
    worst = larger(worst, std::abs(found.value[c] / (p * size * size * size) - 1.0));
  }
  return {worst, 1e-5};  // attenuation and double scattering are neglected
}

/// Checks that a needle along y gives the same values as one along x, with lights and views turned
/// by 90 degrees about z.
Finding quarter_turn_in_space() {
  const Bulk bulk{1, 0.5, 0.9, 1};
  const auto request = [](double turn) {
    return intensity_request(
        flatspeckle::Lights{plane_wave(0.5, 0.3 + turn)},
        {far_view(0.4, 1 + turn), far_view(pi / 2, 1 + turn), far_view(2.8, -1 + turn)});
  };
  return in_errors(
      covariance(space_box(1, 1e3, bulk, request(pi / 2)), ReversedPaths::no, 40000, 1),
      covariance(space_box(1e3, 1, bulk, request(0)), ReversedPaths::no, 40000, 2), 0.1);
}

/// Checks |C_ab|^2 <= C_aa C_bb for lights and views along the edges of a box 1000 mean free paths
/// long. Variances below 1e-308 underflow to 0 and are excepted.
Finding along_edges() {
  const auto request = full_request(
      flatspeckle::Lights{plane_wave(0), plane_wave(pi / 2), plane_wave(pi / 2, pi / 2)},
      {far_view(0), far_view(pi), far_view(pi / 2), far_view(pi / 2, pi / 2)});
  const Estimate found =
      covariance(space_box(1e-3, 1e-3, {1e3, 0.5, 0.9, 1e3}, request), ReversedPaths::yes, 4000);
  double worst = found.value.front().real() >= 0 ? 0 : 2;
  for (std::size_t a = 0; a < request.channels.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const double bound = std::sqrt(found.value[triangle_entry(a, a)].real()) *
                           std::sqrt(found.value[triangle_entry(b, b)].real());
      worst = larger(worst, std::abs(found.value[triangle_entry(a, b)]) / (bound + 1e-150));
    }
  return {worst, 1 + 1e-12};
}

/// Checks that lights and views along z give the same values for any azimuth.
Finding along_z(double azimuth) {
  const auto found = [](double by) {
    const auto request = intensity_request(flatspeckle::Lights{plane_wave(0, by)},
                                           {far_view(0, -by), far_view(pi, 2 * by)});
    return covariance(space_box(20, 20, {2.5, 0.5}, request), ReversedPaths::yes, 4000).value;
  };
  return {relative_difference(found(azimuth), found(0)), 1e-10};
}

/// Checks reciprocity (S23): a near source with far-field detection against a plane wave with a
/// near sensor at the same point.
Finding near_reciprocity_in_space(Vec point) {
  const std::vector<View> views{far_view(0.3, 1), far_view(pi - 0.4, -2)};
  const Bulk bulk{2.5, 0.5};
  flatspeckle::Lights back;
  for (const View& view : views) back.push_back(plane_wave(pi - view.angle, view.azimuth + pi));
  const Estimate from = covariance(
      space_box(20, 15, bulk, intensity_request(flatspeckle::Lights{point_source(point)}, views)),
      ReversedPaths::automatic, 40000, 1);
  const Estimate to =
      covariance(space_box(20, 15, bulk, intensity_request(back, {near_sensor(point)})),
                 ReversedPaths::automatic, 40000, 2);
  return in_errors(from, to, 0.15, 16 * pi * pi);
}

/// Checks that the intensity is continuous when a sensor crosses a face, an edge or a corner.
Finding across_edge_in_space(Vec point, Vec outwards) {
  const auto at = [&](double off) {
    const auto request = intensity_request(flatspeckle::Lights{plane_wave(0.2, 0.5)},
                                           {near_sensor(point + off * outwards)});
    return covariance(space_box(20, 20, {2.5, 0.5}, request), ReversedPaths::automatic, 4000)
        .value[0];
  };
  const Complex on = at(0);
  return {larger(std::abs(at(1e-9) / on - 1.0), std::abs(at(-1e-9) / on - 1.0)), 1e-6};
}

/// Checks that a very distant point source gives the same values as a plane wave.
Finding far_source_in_space() {
  const double r = 1e9;
  const std::vector<View> views{far_view(0.2, 1), far_view(1.3, -2), far_view(pi - 0.2)};
  const Bulk bulk{2.5, 0.5};
  const flatspeckle::Light wave = plane_wave(0.6, 0.8);
  const flatspeckle::Light source = point_source(-r * wave.direction());
  const auto run = [&](const flatspeckle::Light& light, std::uint64_t seed) {
    return covariance(space_box(20, 20, bulk, intensity_request(flatspeckle::Lights{light}, views)),
                      ReversedPaths::automatic, 20000, seed);
  };
  return in_errors(run(source, 3), run(wave, 4), 0.1, 16 * pi * pi * r * r);
}

/// Checks that the mean of 1 - cos of scattering angles is 1 - g.
Finding turns_in_space(double g) {
  const mc::HenyeyGreensteinInSpace scattering{{g}};
  RandomStream random(3, 2, 0);
  return mean_in_errors(
      400000,
      [&](int i) {
        const Vec from = direction(0.3 * i, 0.7 * i), step = scattering.sample(from, random) - from;
        return dot(step, step) / 2;
      },
      1 - g, 0.1);
}

/// Checks the phase function at tiny angles, where computing 1 - cos would lose all digits.
Finding forward_density_in_space() {
  const double g = 0.999;
  const mc::HenyeyGreensteinInSpace scattering{{g}};
  return worst_of({0.0, 1e-12, 1e-8, 1e-4, 1e-3}, 1e-12, [&](double turn) {
    const long double h = std::sin(static_cast<long double>(turn) / 2),
                      rest = 1 - static_cast<long double>(g);
    const long double exact = rest * (1 + g) / (4 * std::numbers::pi_v<long double>) /
                              std::pow(rest * rest + 4 * g * h * h, 1.5L);
    const double found = scattering.density(direction(1, 2), direction(1 + turn, 2));
    return static_cast<double>(std::abs(found / exact - 1));
  });
}

/// Checks the optical theorem of a sphere (C57): its extinction equals its scattering if its index
/// is real, and exceeds it otherwise. The amplitude towards all directions must contain the same
/// power.
Finding sphere_power(double size, Complex index) {
  const Scatterer sphere{.kind = Scatterer::Kind::tm, .radius = size / k, .index = index};
  const int order = isolated_order(sphere, k, 1e-17, Radial::spherical);
  const auto t = t_matrix(sphere, k, order, Radial::spherical);
  const CrossSections found = cross_sections_in_space(t, k);
  const double absorbed = found.extinction / found.scattering - 1;
  const double forward = 4 * pi / k * amplitude_in_space(t, k, 1).imag() / found.extinction - 1;
  const double off = index.imag() == 0 ? std::abs(absorbed) : larger(0, -absorbed);
  return {larger(off, std::abs(forward)), 1e-11};
}

/// Checks that turning all lights and views of a slab about z leaves its covariance by transport.
Finding turned_slab(double angle, double turn) {
  const auto at = [&](double by) {
    Scene scene = mc::in_space(hg_slab({2, 0.7}, {}), [] {
      SceneSpec spec;
      spec.scatterer = "hg";
      spec.g = 0.7;
      return spec;
    }());
    scene.request =
        memory_effect_request(k, plane_wave(angle, by),
                              {far_view(0.4, 2 + by), far_view(2.5, -1 + by)}, {0, 1e-3}, 1 + by);
    return mc::slab_covariance(scene, false, {1e-6}).value;
  };
  return {relative_difference(at(turn), at(0)), 1e-6};
}

/// Checks the integral of a plane wave over a box without attenuation, with k L = 1e6 along all
/// sides: sinc functions times the volume.
Finding wave_integral_in_space(Vec kappa) {
  const double extent = 1e6 / k;
  const Domain domain{Domain::Kind::box, extent, extent, extent};
  const auto found = mc::attenuated_wave_integral(
      domain, 0, kappa, {direction(0.1, 1), direction(3, 2), direction(1.57, -1), {0, -1}});
  const auto sinc = [](double a) { return a == 0 ? 1 : std::sin(a) / a; };
  const Complex exact = domain.content() * sinc(kappa.x * extent / 2) * sinc(kappa.z * extent / 2) *
                        sinc(kappa.y * extent / 2) * std::polar(1.0, kappa.z * extent / 2);
  return {std::abs(found - exact) / domain.content(), 1e-12};
}

/// Checks the integral for backscattering: int exp(-2 mu_t z).
Finding backscattering_integral_in_space(double optical_depth) {
  const Domain domain{Domain::Kind::box, 20, 10, 5};
  const double mu_t = optical_depth / 10;
  const double exact = -100 * std::expm1(-2 * optical_depth) / (2 * mu_t);
  const Vec up{0, -1};
  return {std::abs(mc::attenuated_wave_integral(domain, mu_t, {}, {up, up, up, up}) / exact - 1.0),
          1e-9};
}

/// Checks the integral for rays that almost coincide with the diagonal of a cube: a small rotation
/// changes it little.
Finding diagonal_integral(double turn) {
  const Domain cube{Domain::Kind::box, 10, 10, 10};
  const double angle = std::acos(1 / std::sqrt(3.0));
  const auto at = [&](double by) {
    const Vec w = direction(angle + by, pi / 4 + by);
    return mc::attenuated_wave_integral(cube, 0.3, {1, 2, 3}, {w, -w, w, -w});
  };
  return {std::abs(at(turn) - at(0)) / cube.content(), 1e-12 + 10 * turn};
}

}  // namespace

void mc_space_extremes(ExtremeRows& rows) {
  rows.add("box in space of 1e-6 mean free paths", "mu_s p volume", speck_in_space);
  rows.add("needle of 1 x 1e3 x 1 mean free paths", "the needle turned, in errors",
           quarter_turn_in_space);
  rows.add("box in space along its edges, OD 1000", "Cauchy-Schwarz, entry by entry", along_edges);
  rows.add_each("light and views along z, azimuth ", {1e-12, 1.0, 1e6}, "", "azimuth 0", along_z);
  const std::string reciprocity = "near source and sensor exchanged, in errors";
  rows.add("sensor in space on the back face", reciprocity, [] {
    return near_reciprocity_in_space({1, 10, 2});
  });
  rows.add("sensor in space on a corner", reciprocity, [] {
    return near_reciprocity_in_space({10, 0, 7.5});
  });
  const std::string steady = "no step over 1e-9";
  rows.add("sensor in space through a face", steady, [] {
    return across_edge_in_space({0.5, 0, 1}, {0, -1});
  });
  rows.add("sensor in space through an edge", steady, [] {
    return across_edge_in_space({10, 10, 1}, {1, 1});
  });
  rows.add("sensor in space through a corner", steady, [] {
    return across_edge_in_space({10, 10, 10}, {1, 1, 1});
  });
  rows.add("source in space 1e9 wavelengths away", "plane wave, in errors", far_source_in_space);
  rows.add_each("turns in space of g ", {-0.999, 0.0, 0.999}, "", "mean of 1 - cos, in errors",
                turns_in_space);
  rows.add("g 0.999 in space, turns of 0 to 1e-3", "phase function in long double",
           forward_density_in_space);
  rows.add("wave over a box in space, k L 1e6", "volume", wave_integral_in_space, Vec{});
  rows.add("wave over a box in space, k L 1e6, oblique", "sinc functions", wave_integral_in_space,
           Vec{1e-6, 2e-3, k});
  rows.add_each("single backscattering of a box in space, OD ", {1e-9, 1.0, 1e3}, "",
                "int exp(-2 mu_t z)", backscattering_integral_in_space);
  rows.add_each("rays along the diagonal of a cube, turned by ", {1e-15, 1e-12, 1e-6}, "",
                "hardly any change", diagonal_integral);
  for (const double size : {1e-4, 1.0, 100.0})
    for (const Complex index : {Complex(1.33), Complex(10), Complex(0.1, 5)})
      rows.add("sphere of k a " + short_number(size) + ", index " + short_number(index.real()) +
                   (index.imag() == 0 ? "" : " + " + short_number(index.imag()) + "i"),
               "optical theorem", sphere_power, size, index);
  for (const double angle : {0.0, 1e-9, 1.55})
    rows.add_timed(angle > 0, "slab in space, light at " + short_number(angle) + ", turned by 2",
                   "as before", turned_slab, angle, 2.0);
}

}  // namespace flatspeckle::bench

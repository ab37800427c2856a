// Paths in boxes that are needles, sheets or specks; sensors and sources on the edge of the medium
// and inside.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/stability/extreme_rows.h"
#include "bench/stability/mc_extremes.h"
#include "mc/paths/endpoint_factors/coherent_field.h"
#include "mc/paths/endpoint_factors/scattering.h"

namespace flatspeckle::bench {

namespace {

using mc::ReversedPaths;
using std::numbers::pi;

/// Checks a tiny box, in which only single scattering matters: mu_s times the phase function times
/// the area.
Finding speck() {
  const double size = 1e-6, g = 0.5;
  const auto request = intensity_request({0, 1.0, pi / 2}, far_views({0.3, pi / 2, -2.0}));
  const Scene scene = hg_box(size, {size, g, 1, size}, request);
  const Estimate found = covariance(scene, ReversedPaths::no, 4000);
  double worst = 0;
  for (std::size_t c = 0; c < request.channels.size(); ++c) {
    const Channel channel = request.channels[c];
    const double angle = request.views[channel.view].angle - request.lights[channel.light].angle;
    const double p = (1 - g * g) / (2 * pi * (1 + g * g - 2 * g * std::cos(angle)));
    worst = larger(worst, std::abs(found.value[c] / (p * size * size) - 1.0));
  }
  return {worst, 1e-5};  // attenuation and double scattering are neglected
}

/// Checks that a needle, illuminated and viewed across its axis, gives the same values as a sheet
/// turned by 90 degrees, illuminated and viewed along its normal.
Finding quarter_turn() {
  const auto across = intensity_request({pi / 2}, far_views({pi / 2 + 0.4, -pi / 2, pi / 2 + 1.5}));
  const auto through = intensity_request({0}, far_views({0.4, pi, 1.5}));
  const Bulk needle{1e3, 0.5, 0.9, 1e3}, sheet{1e-3, 0.5, 0.9, 1e-3};
  const Estimate a = covariance(hg_box(1e-3, needle, across), ReversedPaths::no, 16000, 1);
  const Estimate b = covariance(hg_box(1e3, sheet, through), ReversedPaths::no, 16000, 2);
  return in_errors(a, b, 0.1);
}

/// Checks |C_ab|^2 <= C_aa C_bb for the needle, illuminated and viewed along its axis, which is
/// 1000 mean free paths long. Variances below 1e-308 underflow to 0 and are excepted.
Finding along_needle() {
  const auto request = full_request({0, 1e-3, pi / 2}, far_views({0, pi, pi / 2}));
  const Estimate found =
      covariance(hg_box(1e-3, {1e3, 0.5, 0.9, 1e3}, request), ReversedPaths::yes, 4000);
  const auto entry = [&](std::size_t a, std::size_t b) { return found.value[a * (a + 1) / 2 + b]; };
  double worst = entry(1, 1).real() > 0 ? 0 : 2;
  for (std::size_t a = 0; a < request.channels.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const double bound = std::sqrt(entry(a, a).real()) * std::sqrt(entry(b, b).real());
      worst = larger(worst, std::abs(entry(a, b)) / (bound + 1e-150));
    }
  return {worst, 1 + 1e-12};
}

/// Checks reciprocity (C13): a near source with far-field detection against a plane wave with a
/// near sensor at the same point, on faces, on corners and inside.
Finding near_reciprocity(Vec point) {
  const std::vector<double> views{0.3, pi - 0.4};
  const Bulk bulk{2.5, 0.5};
  flatspeckle::Lights back;
  for (const double view : views) back.push_back(plane_wave(view + pi));
  const Estimate from = covariance(
      hg_box(20, bulk,
             intensity_request(flatspeckle::Lights{point_source(point)}, far_views(views))),
      ReversedPaths::automatic, 40000, 1);
  const Estimate to = covariance(hg_box(20, bulk, intensity_request(back, {near_sensor(point)})),
                                 ReversedPaths::automatic, 40000, 2);
  return in_errors(from, to, 0.15, 8 * pi * k);
}

/// Checks that the intensity is continuous when a sensor crosses a face or a corner.
Finding across_edge(Vec point, Vec outwards) {
  const auto at = [&](double off) {
    const auto request = intensity_request({0.2}, {near_sensor(point + off * outwards)});
    return covariance(hg_box(20, {2.5, 0.5}, request), ReversedPaths::automatic, 4000).value[0];
  };
  const Complex on = at(0);
  return {larger(std::abs(at(1e-9) / on - 1.0), std::abs(at(-1e-9) / on - 1.0)), 1e-6};
}

/// Checks that a very distant point source gives the same values as a plane wave; k r = 6e9 enters
/// all phases.
Finding far_source() {
  const double r = 1e9;
  const auto views = far_views({0.2, 1.3, pi - 0.2});
  const Bulk bulk{2.5, 0.5};
  const Estimate source = covariance(
      hg_box(20, bulk,
             intensity_request(flatspeckle::Lights{point_source(-r * direction(0.6))}, views)),
      ReversedPaths::automatic, 20000, 3);
  const Estimate wave = covariance(hg_box(20, bulk, intensity_request({0.6}, views)),
                                   ReversedPaths::automatic, 20000, 4);
  return in_errors(source, wave, 0.1, 8 * pi * k * r);
}

Finding empty_box() {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = 0;
  Scene scene = make_scene(spec);
  scene.request = full_request({0, pi / 2}, far_views({0, pi}));
  const Estimate found = covariance(scene, ReversedPaths::yes, 4000);
  double sum = total_magnitude(found);
  for (const Complex mean : mc::coherent_field(scene)) sum += std::abs(mean);
  return {sum, 0};
}

/// Checks that the mean of 1 - cos of scattering angles is 1 - g.
Finding turns(double g) {
  const mc::HenyeyGreensteinScattering scattering{{g}};
  RandomStream random(3, 1, 0);
  return mean_in_errors(
      400000,
      [&](int i) {
        const Vec from = direction(0.3 * i), step = scattering.sample(from, random) - from;
        return dot(step, step) / 2;
      },
      1 - g, 0.1);
}

/// Checks the phase-function density at tiny angles, where computing 1 - cos would lose all digits.
Finding forward_density() {
  const double g = 0.999;
  const mc::HenyeyGreensteinScattering scattering{{g}};
  return worst_of({0.0, 1e-12, 1e-8, 1e-4, 1e-3}, 1e-12, [&](double turn) {
    const long double h = std::sin(static_cast<long double>(turn) / 2),
                      rest = 1 - static_cast<long double>(g);
    const long double exact =
        rest * (1 + g) / (2 * std::numbers::pi_v<long double> * (rest * rest + 4 * g * h * h));
    const double found = scattering.density(direction(1), direction(1 + turn));
    return static_cast<double>(std::abs(found / exact - 1));
  });
}

}  // namespace

void mc_box_extremes(ExtremeRows& rows) {
  rows.add("box of 1e-6 mean free paths", "mu_s p area", speck);
  rows.add("needle of 1e-3 x 1e3 mean free paths", "the sheet turned, in errors", quarter_turn);
  rows.add("needle along itself, OD 1000, grazing", "Cauchy-Schwarz, entry by entry", along_needle);
  rows.add("empty box", "no field, no covariance", empty_box);
  const std::string reciprocity = "near source and sensor exchanged, in errors";
  rows.add("sensor on the back face", reciprocity, [] { return near_reciprocity({1, 10}); });
  rows.add("sensor on a corner", reciprocity, [] { return near_reciprocity({10, 0}); });
  rows.add("sensor inside", reciprocity, [] { return near_reciprocity({0.3, 4}); });
  const std::string steady = "no step over 1e-9";
  rows.add("sensor through the front face", steady, [] { return across_edge({0.5, 0}, {0, -1}); });
  rows.add("sensor through a corner", steady, [] { return across_edge({10, 10}, {1, 1}); });
  rows.add("source 1e9 wavelengths away", "plane wave, in errors", far_source);
  rows.add_each("turns of g ", {-0.999, 0.0, 0.999}, "", "mean of 1 - cos, in errors", turns);
  rows.add("g 0.999, turns of 0 to 1e-3", "phase function in long double", forward_density);
}

}  // namespace flatspeckle::bench

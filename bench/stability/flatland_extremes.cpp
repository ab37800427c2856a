// Scatterers, scenes and requests at the limits of their ranges.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/oracles/multiprecision.h"
#include "bench/scenes/standard_scenes.h"
#include "bench/stability/extreme_rows.h"
#include "flatland/media/structure_factor.h"
#include "flatland/placement/equilibrium_disks.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::bench {

namespace {

using namespace oracles;

using Kind = Scatterer::Kind;
using std::numbers::pi;

/// Returns the largest relative error of T_n, up to five orders beyond the one at which T_n is
/// 1e-15 of the largest.
double t_matrix_error(const Scatterer& scatterer) {
  const int last = isolated_order(scatterer, k, 1e-15) + 5;
  const auto t = scaled_t_matrix(scatterer, k, last);
  double worst = 0;
  for (int n = 0; n <= last; n = n < 4 ? n + 1 : n + 1 + last / 12)
    worst = larger(worst, relative_error(wide(t[n]), wide_t(scatterer, k, n)));
  return worst;
}

Finding t_matrix_row(Kind kind, Complex index, double limit) {
  return worst_of({1e-4, 1.0, 100.0}, limit,
                  [&](double ka) { return t_matrix_error(disk(kind, ka, index)); });
}

/// Checks |1 + 2 T_n| = 1 for a lossless scatterer.
Finding lossless(const Scatterer& scatterer, double limit) {
  double worst = 0;
  for (const ExtendedComplex t : t_matrix(scatterer, k, isolated_order(scatterer, k, 1e-15)))
    worst = larger(worst, static_cast<double>(std::abs(std::abs(1.0L + 2.0L * t) - 1)));
  return {worst, limit};
}

/// Compares sigma_s and g with the integral of |A|^2, by the trapezoidal rule.
Finding integrals(const Scatterer& scatterer, double limit) {
  const auto t = t_matrix(scatterer, k, isolated_order(scatterer, k, 1e-15));
  const std::size_t intervals = 8 * t.size();
  const auto a = amplitudes(t, k, intervals);
  double sum = 0, cosine = 0;
  for (std::size_t i = 0; i <= intervals; ++i) {
    const double theta = pi * static_cast<double>(i) / static_cast<double>(intervals);
    const double part = std::norm(a[i]) * (i == 0 || i == intervals ? 1 : 2);
    sum += part;
    cosine += part * std::cos(theta);
  }
  const auto sections = cross_sections(t, k);
  const double scattered = sum * pi / static_cast<double>(intervals);
  return {
      larger(std::abs(scattered / sections.scattering - 1), std::abs(cosine / sum - sections.g)),
      limit};
}

SceneSpec box() {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  return spec;
}
SceneSpec hg(double g, double albedo, double optical_depth = 1) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 10;
  spec.scatterer = "hg";
  spec.g = g;
  spec.albedo = albedo;
  spec.optical_depth = optical_depth;
  return spec;
}

Finding optical_depths() {
  double worst = 0;
  for (const double depth : {1e-12, 1e-3, 1.0, 100.0, 1e4})
    for (const char* kind : {"hg", "point", "te"}) {
      SceneSpec spec = hg(0, 1, depth);
      spec.scatterer = kind;
      if (spec.scatterer != "hg") spec.g.reset();
      if (spec.scatterer == "te") {
        spec.albedo.reset();
        spec.radius = 1e-6;  // so small that many disks fit into the box
        if (depth > 1e-6) continue;
      }
      worst = larger(worst, std::abs(make_scene(spec).medium.mu_t * 10 / depth - 1));
    }
  return {worst, 1e-14};
}

/// Checks mu_t - mu_s = mu_t (1 - albedo) despite cancellation.
Finding absorption() {
  const double albedo = 1 - 1e-9;
  SceneSpec points = hg(0, albedo);
  points.scatterer = "point";
  points.g.reset();
  double worst = 0;
  for (const SceneSpec& spec : {hg(0.999, albedo), points}) {
    const BulkMedium medium = make_scene(spec).medium;
    worst = larger(worst, std::abs((medium.mu_t - medium.mu_s) / (medium.mu_t * (1 - albedo)) - 1));
  }
  return {worst, 1e-6};
}

Finding transport_lengths() {
  return worst_of({-0.999, 0.0, 0.999}, 1e-12, [&](double g) {
    const BulkMedium medium = make_scene(hg(g, 1)).medium;
    return std::abs(medium.transport_mean_free_path() * medium.mu_t * (1 - g) - 1);
  });
}

/// Checks placements of no scatterer or one.
Finding few_scatterers(std::int64_t count) {
  SceneSpec spec = box();
  spec.count = count;
  const Scene scene = make_scene(spec);
  RandomStream random(1, 1, 0);
  double wrong = std::abs(scene.medium.mu_t * 200 - static_cast<double>(count) * 4 / k);
  for (int draw = 0; draw < 100; ++draw) {
    const auto placement = draw_placement(scene.domain, scene.scatterer, scene.placement, random);
    if (placement.size() != static_cast<std::size_t>(count)) ++wrong;
    for (const auto& one : placement)
      if (!scene.domain.contains(one.position)) ++wrong;
  }
  return {wrong, 1e-14};
}

/// Checks the phase error k L (sin v2 - sin v1 - q / k) of matched detection directions v1, v2 for
/// k L = 1e6. Rounding the angles to 1e-16 contributes 1e-10.
Finding matched_views() {
  double worst = 0;
  for (const double light : {0.0, 0.8, 1.5})
    for (const double tilt : {1e-12, -1e-6, 1e-3}) {
      const std::vector<double> views{0.0, -0.3, 1.2, pi - 0.2, 1.5};
      const auto request = memory_effect_request(k, light, views, {tilt});
      for (std::size_t v = 0; v < views.size(); ++v) {
        const Entry entry = request.entries[request.tilted_entry(0, v)];
        const Channel a = request.channels[entry.a], b = request.channels[entry.b];
        const auto sine = [](long double angle) { return std::sin(angle); };
        const long double in = sine(static_cast<long double>(light) + tilt) - sine(light);
        const long double out =
            sine(request.views[b.view].angle) - sine(request.views[a.view].angle);
        worst = larger(worst, static_cast<double>(std::abs(1e6L * (out - in))));
      }
    }
  return {worst, 1e-9};
}

/// Checks that tilt 0 gives exactly the untilted channel.
Finding no_tilt() {
  const auto request = memory_effect_request(k, 1.5, {0.1, 1.55, pi}, {0.0});
  double wrong = std::abs(request.tilt_q[0]);
  for (std::size_t v = 0; v < 3; ++v)
    if (const Entry e = request.entries[request.tilted_entry(0, v)]; e.a != e.b) ++wrong;
  return {wrong, 0};
}

/// Checks distances to the edge in directions exactly along the axes (cos(pi/2) = 6e-17 in floating
/// point), from points inside and from corners.
Finding edges() {
  const Domain domain{Domain::Kind::box, 20, 10};
  double worst = 0;
  const auto check = [&](Vec from, double angle, double expected) {
    worst = larger(worst, std::abs(domain.distance_to_edge(from, direction(angle)) - expected));
  };
  check({3, 5}, pi / 2, 7);
  check({3, 5}, -pi / 2, 13);
  check({3, 5}, pi, 5);
  check({3, 1e-15}, pi / 2, 7);
  check({10, 10}, 0.7, 0);
  check({-10, 0}, pi / 4, 10 * std::numbers::sqrt2);
  check({0, 0}, pi, 0);
  return {worst, 1e-14};
}

/// Checks S(0) = 1 / [d(eta Z) / d eta] for hard disks of packing fraction eta, with the
/// compressibility factor Z = (1 + eta^2/8) / (1 - eta)^2. The stiffness 1/S(0), 70 at packing
/// 0.69, amplifies the 1e-6 error of Simpson's rule for c(q).
Finding compressibility(double eta) {
  const double rest = 1 - eta, z = 1 + eta * eta / 8;
  const double stiffness = ((z + eta * eta / 4) * rest + 2 * eta * z) / (rest * rest * rest);
  const HardDiskFluid fluid(eta, 1);
  return {larger({std::abs(fluid.structure_factor(0) * stiffness - 1),
                  std::abs(fluid.structure_factor(1e-9) * stiffness - 1),
                  std::abs(fluid.structure_factor(1e4) - 1)}),
          eta < 0.1 ? 1e-9 : 1e-3};
}

/// Checks that no two disks overlap; overlaps across the periodic edges are not checked.
Finding dense_fluid() {
  const double radius = 0.5, packing = 0.68;
  const Domain domain{Domain::Kind::box, 12, 10};
  const auto count = static_cast<std::size_t>(packing * domain.content() / (pi * radius * radius));
  const std::vector<double> radii(count, radius);
  RandomStream random(5, 1, 0);
  const auto centres = draw_equilibrium_disks(domain, radii, random);
  double overlap = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < i; ++j)
      overlap = larger(overlap, 2 * radius - length(centres[i] - centres[j]));
  return {overlap, 1e-12};
}

void add_scatterers(ExtremeRows& rows) {
  const std::string sizes = ", k a 1e-4, 1, 100: T_n", digits = "C7 in 50 digits";
  const std::string lossless_t = "|1 + 2 T_n| = 1", area = "integrals of |A|^2";
  const Complex metal(0.1, 5);
  for (const auto& [name, kind] : {std::pair("TM", Kind::tm), {"TE", Kind::te}}) {
    const std::string disks = name;
    // rounding the index m to double loses half of the digits of m - 1; the reference uses the same
    // rounded index
    rows.add(disks + ", index 1 + 1e-8" + sizes, digits, t_matrix_row, kind, 1 + 1e-8, 1e-9);
    rows.add(disks + ", index 10" + sizes, digits, t_matrix_row, kind, 10.0, 1e-12);
    rows.add(disks + ", index 0.1 + 5i" + sizes, digits, t_matrix_row, kind, metal, 1e-12);
    rows.add(disks + ", index 10, k a 1000", lossless_t, lossless, disk(kind, 1000, 10), 1e-13);
  }
  for (const auto& [name, kind] : {std::pair("soft", Kind::soft), {"hard", Kind::hard}}) {
    rows.add(name + sizes, digits, t_matrix_row, kind, 1.0, 1e-12);
    rows.add(std::string(name) + ", k a 10000", lossless_t, lossless, disk(kind, 1e4), 1e-13);
  }
  rows.add("TM, index 0.1 + 5i, k a 100: sigma_s and g", area, integrals,
           disk(Kind::tm, 100, metal), 1e-11);
  rows.add("TE, k a 1000: sigma_s and g", area, integrals, disk(Kind::te, 1000),
           1e-9);  // rounding errors grow as the order squared
}

void add_scenes(ExtremeRows& rows) {
  rows.add("optical depths 1e-12 to 1e4, stated", "mu_t depth", optical_depths);
  rows.add("albedo 1 - 1e-9", "mu_t - mu_s = mu_t (1 - albedo)", absorption);
  rows.add("g -0.999, 0, 0.999", "transport mean free path", transport_lengths);
  rows.add("no scatterer", "count, mu_t", few_scatterers, 0);
  rows.add("one scatterer", "count, mu_t, its place", few_scatterers, 1);
  rows.add("views matched to tilts of 1e-12 to 1e-3", "phase over k L = 1e6", matched_views);
  rows.add("tilt 0, light and view grazing", "the same channel", no_tilt);
  rows.add("distance to the edge along the edge, and from corners", "closed form", edges);
  rows.add_each("structure factor of disks, packing ", {1e-9, 0.69}, "", "S(0), S(infinity)",
                compressibility);
  rows.add("equilibrium disks, packing 0.68", "overlap of any two", dense_fluid);
}

void add_refusals(ExtremeRows& rows) {
  rows.add_refused("a tilt that takes the light past the horizon", "tilts = 0.2: takes the light",
                   [] { memory_effect_request(k, 1.5, {0.1}, {0.2}); });
  rows.add_refused("a tilt that takes a view past the horizon", "tilts = 0.2: takes view angle 1.5",
                   [] {
                     memory_effect_request(k, 0, {0.1, 1.5}, {0.2});
                   });
  const auto refuse = [&](const char* name, const char* must_say, SceneSpec spec,
                          const std::function<void(SceneSpec & s)>& change) {
    change(spec);
    rows.add_refused(
        name, must_say, [](const SceneSpec& of) { make_scene(of); }, spec);
  };
  const SceneSpec slab = hg(0, 1);
  SceneSpec disks = box();
  disks.scatterer = "tm";
  disks.radius = 0.2;
  disks.index = "1.5";
  refuse("g = 1", "g = 1: must be in (-1, 1)", slab, [](auto& s) { s.g = 1; });
  refuse("albedo 1 + 2e-16", "must be from 0 to 1", slab, [](auto& s) { s.albedo = 1 + 0x1p-52; });
  refuse("optical depth 0", "optical_depth = 0: must be positive", slab,
         [](auto& s) { s.optical_depth = 0; });
  refuse("optical depth NaN", "optical_depth", slab,
         [](auto& s) { s.optical_depth = std::nan(""); });
  refuse("a box of 1e9 wavelengths", "at most 1e8 wavelengths", box(), [](auto& s) {
    s.width = 1e9;
    s.count = 1;
  });
  refuse("disks of index 1.5 - 1e-12i", "must not be 0 and must not amplify", disks,
         [](auto& s) { s.index = "1.5-1e-12i"; });
  refuse("random hard disks, packing 0.55", "packing fraction", disks,
         [](auto& s) { s.density = 0.55 / (pi * 0.04); });
  refuse("equilibrium disks, packing 0.7", "freezes near 0.7", disks, [](auto& s) {
    s.placement = "equilibrium";
    s.density = 0.7 / (pi * 0.04);
  });
  refuse("light along a slab from below, 3 pi / 4", "light enters a slab at z = 0", slab,
         [](auto& s) { s.light_angles = {3 * pi / 4}; });
  refuse("full covariance of 1e6 channels", "GB of memory; available GB", box(), [](auto& s) {
    s.count = 1;
    s.covariance = "full";
    s.view_angles.clear();
    for (int i = 0; i < 1'000'000; ++i) s.view_angles.push_back(1e-6 * i);
  });
}

}  // namespace

void flatland_extremes(ExtremeRows& rows) {
  add_scatterers(rows);
  add_scenes(rows);
  add_refusals(rows);
}

}  // namespace flatspeckle::bench

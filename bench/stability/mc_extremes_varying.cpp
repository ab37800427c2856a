// Media whose density or index varies extremely.

#include <cmath>
#include <numbers>

#include "bench/stability/extreme_rows.h"
#include "bench/stability/mc_extremes.h"
#include "flatland/media/layers.h"
#include "flatland/scene/density_maps.h"
#include "mc/paths/bent/graded_endpoints.h"
#include "mc/paths/bent/linear_medium.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::bench {

namespace {

using std::numbers::pi;

/// Compares a homogeneous slab with layers of the same total optical depth.
Finding as_undivided(const std::vector<double>& densities, const std::vector<double>& depths) {
  constexpr double tolerance = 1e-8;
  const Scene slab = hg_slab({5, 0.7}, intensity_request({0.3}, far_views({0.2, 1.2, pi - 0.5})));
  Scene layered = slab;
  std::vector<Material> materials;
  std::vector<double> thicknesses;
  for (std::size_t l = 0; l < densities.size(); ++l) {
    Material& material = materials.emplace_back(Material{slab.scatterer, slab.medium});
    material.medium.mu_t *= densities[l];
    material.medium.mu_s *= densities[l];
    thicknesses.push_back(depths[l] * slab.domain.depth);
  }
  layered.profile = std::make_shared<const Layers>(materials, thicknesses);
  layered.domain.depth = thicknesses[0] + thicknesses[1];
  layered.medium = layered.profile->mean();
  return {relative_difference(mc::slab_covariance(layered, false, {tolerance}).value,
                              mc::slab_covariance(slab, false, {tolerance}).value),
          1e-6};
}

/// Checks that the distance returned for an optical depth has that optical depth, through cells of
/// density 1e6 and 0.
Finding rugged_map() {
  const Scene box = hg_box(20, {5}, intensity_request({0}, far_views({0})));
  const CellDensity map(box.domain, {box.scatterer, box.medium}, {4, 4},
                        {1, 0, 1e6, 1, 1e-6, 1, 0, 1, 0, 0, 1, 1e6, 1, 1, 1, 0});
  double worst = 0;
  for (const double angle : {0.0, 0.3, -1.2, pi / 2})
    for (const double share : {1e-6, 0.3, 0.999}) {
      const Vec x{0.3, 1e-3}, w = direction(angle);
      const double edge = box.domain.distance_to_edge(x, w),
                   depth = share * map.optical_depth(x, w, edge),
                   length = map.reach(x, w, depth, edge);
      worst = larger(worst, std::abs(map.optical_depth(x, w, length) / depth - 1));
    }
  return {worst, 1e-9};
}

flatspeckle::IndexField linear(Vec gradient) {
  flatspeckle::IndexField field;
  field.kind = flatspeckle::IndexField::Kind::linear;
  field.gradient = gradient;
  return field;
}

/// Compares curved rays traced in both directions, between near and far endpoints.
Finding curves_in_both_senses() {
  const mc::LinearMedium medium({Domain::Kind::box, 20, 10}, linear({0.01, 0.05}));
  double worst = 0;
  for (const double distance : {1e-9, 1e-3, 1.0, 20.0}) {
    const Vec from{0.2, 0.1}, to = from + distance * direction(0.4);
    const auto there = medium.curve(from, to), back = medium.curve(to, from);
    if (!there || !back) return {1, 0};
    worst = larger({worst, std::abs(there->path / back->path - 1),
                    std::abs(there->spread / back->spread - 1),
                    std::abs(there->inside / back->inside - 1)});
  }
  return {worst, 1e-12};
}

/// Checks a ray along z in a medium whose n^2 falls from 1 to 1e-6 at the back: z = sigma - sigma^2
/// (1 - 1e-6) / (4 depth).
Finding nearly_turning() {
  constexpr double depth = 10, fall = (1 - 1e-6) / depth;
  const mc::LinearMedium medium({Domain::Kind::box, 20, depth}, linear({0, -fall}));
  double worst = 0;
  for (const double sigma : {1e-6, 1.0, 10.0, 19.9}) {
    const auto place = medium.after_flight({0, 0}, {0, 1}, sigma);
    if (!place) return {1, 0};
    worst = larger(worst, std::abs(place->x.z / (sigma - fall * sigma * sigma / 4) - 1));
  }
  return {worst, 1e-9};
}

/// Checks |g1| = 1 for scatterers that only flow uniformly.
Finding fast_flow() {
  const Scene slab = hg_slab({5, 0.7}, intensity_request({0.3}, far_views({0.2, pi - 0.5})));
  const auto job = mc::delay_job(slab, mc::make_plan(slab, mc::ReversedPaths::no), {1}, 1,
                                 {.diffusion = 0, .velocity = {1e6, -3e5}});
  const auto sums = summed(job.field.batches, 4000);
  const auto values = job.all(sums.total_samples(), sums.total());
  double worst = 0;
  for (std::size_t e = 0; e < job.entries; ++e)
    worst = larger(worst, std::abs(std::abs(values[job.entries + e] / values[e]) - 1));
  return {worst, 1e-8};
}

SceneSpec graded(const std::string& field) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.density = 0.155;
  spec.index_field = field;
  return spec;
}

void with_ends(const SceneSpec& spec) {
  const Scene scene = make_scene(spec);
  mc::check_graded_endpoints(scene, *mc::graded_medium(scene));
}

void grazing_mean_field() {
  SceneSpec spec = graded("mean_field");
  spec.domain = "slab";
  spec.width = std::nullopt;
  spec.scatterer = "tm";
  spec.radius = 0.1;
  spec.index = "0.7";
  spec.density = 1;
  spec.light_angles = {1.5};
  with_ends(spec);
}

void turning_light() {
  SceneSpec spec = graded("linear");
  spec.index_gradient = {0, -0.09};
  spec.light_angles = {1.2};
  with_ends(spec);
}

void focused_light() {
  SceneSpec spec = graded("parabolic");
  spec.axis_index = 6;
  spec.index_alpha = 0.5;
  with_ends(spec);
}

}  // namespace

void mc_varying_extremes(ExtremeRows& rows) {
  using Layered = std::vector<double>;
  for (const double share : {1e-9, 0.3})
    rows.add("layers, one of " + short_number(share) + " of the depth", "the undivided slab",
             as_undivided, Layered{1, 1}, Layered{share, 1 - share});
  rows.add("layers, one of 1e-12 of the density", "without it", as_undivided, Layered{1e-12, 1},
           Layered{1, 1});
  rows.add("density map, cells of 0 to 1e6", "reach of an optical depth", rugged_map);
  rows.add("n^2 linear, ends 1e-9 to 20 apart", "the curve back", curves_in_both_senses);
  rows.add("n^2 falling to 1e-6", "parabola", nearly_turning);
  rows.add("flow of 1e6 wavelengths", "|g1| = 1", fast_flow);
  rows.add_refused("light that turns round where n^2 falls", "turns round at z", turning_light);
  rows.add_refused("light beyond a focus of a guide", "caustic", focused_light);
  rows.add_refused("grazing light on a mean field of index below 1", "reflected at the face",
                   grazing_mean_field);
}

}  // namespace flatspeckle::bench

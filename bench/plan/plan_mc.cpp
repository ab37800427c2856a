#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "bench/oracles/discrete_ordinates.h"
#include "bench/plan/plan_timing.h"
#include "bench/scenes/standard_scenes.h"
#include "flatland/media/layers.h"
#include "flatland/scene/density_maps.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/dynamics/frequency_shifts.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/gradient.h"
#include "mc/slab/adding/space.h"

namespace flatspeckle::bench {

namespace {

using mc::Plan;
using std::numbers::pi;
constexpr std::uint64_t first_seed = 1;

SampledKernel kernel_of(const FieldJob& job) {
  return {job.batches.size, job.batches.samples_per_batch, job.batches.run, job.covariance};
}

Plan plan_without_reversed(const Scene& scene) {
  return mc::make_plan(scene, mc::ReversedPaths::no);
}

/// A scene and its name in the rows.
struct NamedScene {
  std::string name;
  Scene scene;
};

/// Makes the general and the specialised kernel of a scene.
using Kernels = TwoKernels (*)(const Scene& scene);

PlanCase case_of(const std::string& left_out, const NamedScene& on, Draws numbers,
                 Kernels kernels) {
  return case_of_samples({"mc", left_out, on.name, "path"}, numbers, Measure::sample,
                         [=, scene = on.scene] { return kernels(scene); });
}

/// Compares a scene's own kernel with the one that `generalise` makes of its plan.
PlanCase flag(const std::string& left_out, const NamedScene& on, Draws numbers, Measure measure,
              void (*generalise)(Plan&)) {
  return case_of_samples(
      {"mc", left_out, on.name, "path"}, numbers, measure, [=, scene = on.scene]() -> TwoKernels {
        const Plan special = plan_without_reversed(scene);
        Plan general = special;
        generalise(general);
        const std::uint64_t other = numbers == Draws::same ? first_seed : first_seed + 1;
        return {kernel_of(mc::covariance_job(scene, general, first_seed)),
                kernel_of(mc::covariance_job(scene, special, other))};
      });
}

/// Compares the scene `general`, which has a feature without effect on the result, with the scene
/// `special`, which lacks it. If `sampled_single` is true, paths also sample the single scattering
/// of `special`.
TwoKernels beside(const Scene& general, const Scene& special, bool sampled_single = false) {
  Plan plan = plan_without_reversed(special);
  plan.sampled_single |= sampled_single;
  return {kernel_of(mc::covariance_job(general, plan_without_reversed(general), first_seed)),
          kernel_of(mc::covariance_job(special, plan, first_seed + 1))};
}

/// Returns the scene with all pairs of its channels requested.
Scene with_whole_matrix(Scene scene) {
  scene.request.kind = CovarianceRequest::Kind::full;
  scene.request.entries.clear();
  const auto channels = static_cast<std::uint32_t>(scene.request.channels.size());
  for (std::uint32_t a = 0; a < channels; ++a)
    for (std::uint32_t b = 0; b <= a; ++b) scene.request.entries.push_back({a, b});
  return scene;
}

/// Returns an estimator that picks entries from the lower triangle of a matrix.
Estimator picked(const Estimator& triangle, const std::vector<Entry>& entries) {
  return [=](double samples, std::span<const Complex> sums) {
    const auto matrix = triangle(samples, sums);
    std::vector<Complex> values;
    for (const auto [a, b] : entries)
      values.push_back(a >= b ? matrix[a * (a + 1) / 2 + b]
                              : std::conj(matrix[b * (b + 1) / 2 + a]));
    return values;
  };
}

TwoKernels few_entries(const Scene& scene) {
  const Scene whole = with_whole_matrix(scene);
  Plan special = plan_without_reversed(scene), general = plan_without_reversed(whole);
  special.sampled_single = general.sampled_single = true;
  special.paths_per_batch = general.paths_per_batch;
  SampledKernel all = kernel_of(mc::covariance_job(whole, general, first_seed));
  all.estimator = picked(all.estimator, scene.request.entries);
  return {all, kernel_of(mc::covariance_job(scene, special, first_seed))};
}

/// Compares a table of the Henyey-Greenstein phase function with its closed form.
TwoKernels bulk_table(const Scene& scene) {
  Scene table = scene;
  table.scatterer.kind = Scatterer::Kind::other_bulk;
  table.medium.phase = {oracles::henyey_greenstein(scene.scatterer.g), scene.scatterer.g, ""};
  return beside(table, scene);
}

/// Compares two equal layers with the undivided medium.
TwoKernels equal_layers(const Scene& scene) {
  Scene layered = scene;
  const double half = scene.domain.depth / 2;
  layered.profile = std::make_shared<const Layers>(
      std::vector<Material>(2, {scene.scatterer, scene.medium}), std::vector<double>{half, half});
  return beside(layered, scene, true);
}

/// Compares curved rays in an index field of negligible gradient with straight rays, for point
/// sources and near sensors.
TwoKernels curved_rays(const Scene& scene) {
  Scene straight = scene;
  straight.request = full_request({point_source({0, -4}), point_source({0.5, -4})},
                                  {near_sensor({0, 14}), near_sensor({8, 14})});
  Scene graded = straight;
  graded.index.emplace();
  graded.index->kind = IndexField::Kind::linear;
  graded.index->gradient = {0, 1e-9};
  return beside(graded, straight);
}

/// Compares a density map that is 1 everywhere with a homogeneous medium.
TwoKernels even_map(const Scene& scene) {
  constexpr std::size_t rows = 8, columns = 16;
  Scene mapped = scene;
  mapped.profile = std::make_shared<const CellDensity>(
      scene.domain, Material{scene.scatterer, scene.medium}, CellDensity::Counts{columns, rows},
      std::vector<double>(rows * columns, 1));
  return beside(mapped, scene, true);
}

/// Compares mean-field refraction with straight rays, for scatterers that do not shift the
/// wavenumber.
TwoKernels refraction(const Scene& scene) {
  Scene refracted = scene;
  refracted.index.emplace().kind = IndexField::Kind::mean_field;
  return beside(refracted, scene);
}

TwoKernels derivatives(const Scene& scene) {
  const Plan plan = mc::gradient_plan(scene, mc::ReversedPaths::no);
  return {kernel_of(mc::gradient_job(scene, plan, first_seed).field),
          kernel_of(mc::covariance_job(scene, plan, first_seed))};
}

SampledKernel delays_of(const Scene& scene, const mc::Motion& motion = {}) {
  const std::vector<double> times = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2};
  return kernel_of(
      mc::delay_job(scene, plan_without_reversed(scene), times, first_seed, motion).field);
}

TwoKernels delays(const Scene& scene) {
  return {delays_of(scene),
          kernel_of(mc::covariance_job(scene, plan_without_reversed(scene), first_seed))};
}

/// Compares diffusing scatterers with and without a negligible flow.
TwoKernels flow(const Scene& scene) {
  return {delays_of(scene, {.velocity = {1e-300, 0}}), delays_of(scene)};
}

TwoKernels frequencies(const Scene& scene) {
  const std::vector<double> shifts = {1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2};
  const Plan plan = mc::frequency_plan(scene, mc::ReversedPaths::automatic);
  return {kernel_of(mc::frequency_job(scene, plan, shifts, first_seed).field),
          kernel_of(mc::covariance_job(scene, plan, first_seed))};
}

/// Returns a box of points in space, with 64 views at least pi/3 from backscattering, whose
/// enhancement falls slowly with the angle.
Scene points_in_space() {
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = spec.height = 20;
  spec.depth = 10;
  spec.count = 1257;
  Scene scene = mc::in_space(make_scene(spec), spec);
  std::vector<View> views;
  for (int v = 0; v < 64; ++v)
    views.push_back(far_view(std::acos(1 - 1.5 * (v + 0.5) / 64), 2.4 * v));
  scene.request = intensity_request({0}, views);
  return scene;
}

Scene with_request(Scene scene, CovarianceRequest request) {
  scene.request = std::move(request);
  return scene;
}

std::vector<View> views_around(int count) {
  std::vector<View> views;
  for (int v = 0; v < count; ++v) views.push_back(far_view(2 * pi * (v + 0.5) / count));
  return views;
}

}  // namespace

std::vector<PlanCase> mc_plan_cases() {
  const NamedScene points{"box_points, 64 tilts", box_points()};
  const NamedScene slab{"slab_hg g 0, 64 tilts", slab_hg(0)};
  const NamedScene forward{"slab_hg g 0.9, 64 tilts", slab_hg(0.9)};
  const NamedScene around{"box_points, 64 intensities",
                          with_request(points.scene, intensity_request({0}, views_around(64)))};
  const NamedScene full{"box_points, full, 128 channels",
                        with_request(points.scene, full_request({0, 0.1}, views_around(64)))};
  const NamedScene near{points.name + ", near ends", points.scene};
  const NamedScene space{"points in space, 64 intensities", points_in_space()};
  const NamedScene flowing{around.name + ", 8 delays", around.scene};
  constexpr auto same = Draws::same, other = Draws::other;
  constexpr auto sample = Measure::sample, error = Measure::error;
  return {
      flag("anisotropy", points, other, sample,
           [](Plan& plan) { plan.phase = Plan::Phase::henyey_greenstein; }),
      flag("a tabulated amplitude", points, other, sample,
           [](Plan& plan) { plan.phase = Plan::Phase::tabulated; }),
      flag("absorption", points, other, sample, [](Plan& plan) { plan.weighted = true; }),
      flag("reversed paths", slab, other, sample, [](Plan& plan) { plan.reversed = true; }),
      flag("phases", around, same, sample, [](Plan& plan) { plan.phases = true; }),
      case_of("the rest of the matrix", points, same, few_entries),
      flag("updates entry by entry", full, same, sample, [](Plan& plan) { plan.rank_k = false; }),
      flag("paths of one scatterer", points, other, error,
           [](Plan& plan) { plan.sampled_single = true; }),
      flag("negligible contributions", forward, other, error,
           [](Plan& plan) { plan.score_level = 0; }),
      case_of("a table of the phase function", forward, other, bulk_table),
      case_of("variation with depth", points, other, equal_layers),
      case_of("variation with depth", forward, other, equal_layers),
      case_of("a density map", points, other, even_map),
      case_of("curved rays", near, other, curved_rays),
      case_of("refraction of the mean field", slab, other, refraction),
      case_of("derivatives", forward, same, derivatives),
      case_of("8 delays", around, same, delays),
      case_of("flow", flowing, same, flow),
      case_of("8 frequency shifts", around, same, frequencies),
      flag("anisotropy", space, other, sample,
           [](Plan& plan) { plan.phase = Plan::Phase::henyey_greenstein_in_space; }),
      flag("absorption", space, other, sample, [](Plan& plan) { plan.weighted = true; }),
      flag("reversed paths", space, other, sample, [](Plan& plan) { plan.reversed = true; }),
      flag("phases", space, same, sample, [](Plan& plan) { plan.phases = true; }),
  };
}

}  // namespace flatspeckle::bench

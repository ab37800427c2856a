#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "bench/oracles/discrete_ordinates.h"
#include "bench/plan/plan_rooms.h"
#include "bench/plan/plan_timing.h"
#include "bench/scenes/standard_scenes.h"
#include "flatland/media/density_map.h"
#include "flatland/media/layers.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/dynamics/frequency_shifts.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/gradient.h"

namespace flatspeckle::bench {

namespace {

using mc::Plan;
constexpr double pi = std::numbers::pi;
constexpr std::uint64_t seed = 1;

SampledKernel kernel_of(const FieldJob& job) {
  return {job.batches.size, job.batches.samples_per_batch, job.batches.run, job.covariance};
}

Plan plan_of(const Scene& scene) {
  return mc::make_plan(scene, mc::ReversedPaths::no);
}

/// A scene as rows are about it.
struct NamedScene {
  std::string name;
  Scene scene;
};

/// General and special kernel of a row.
using Kernels = std::function<std::pair<SampledKernel, SampledKernel>()>;

PlanCase case_of(const std::string& left_out, const std::string& scene, Numbers numbers,
                 Measure measure, Kernels kernels) {
  return named("mc", left_out, scene, [=](double cpu_seconds) {
    PlanRow row{.per = measure == Measure::sample ? "path" : "1 % error"};
    const auto [general, special] = kernels();
    compare_sampled(row, general, special, numbers, measure, cpu_seconds);
    return row;
  });
}

/// The kernel that a scene would have against the one that `generalise` makes of its plan.
PlanCase flag(const std::string& left_out, const NamedScene& on, Numbers numbers, Measure measure,
              void (*generalise)(Plan&)) {
  return case_of(left_out, on.name, numbers, measure, [=, scene = on.scene] {
    const Plan special = plan_of(scene);
    Plan general = special;
    generalise(general);
    const std::uint64_t other = numbers == Numbers::same ? seed : seed + 1;
    return std::pair{kernel_of(mc::covariance_job(scene, general, seed)),
                     kernel_of(mc::covariance_job(scene, special, other))};
  });
}

/// All entries of a scene's channels.
Scene with_whole_matrix(Scene scene) {
  scene.request.kind = CovarianceRequest::Kind::full;
  scene.request.entries.clear();
  const auto channels = static_cast<std::uint32_t>(scene.request.channels.size());
  for (std::uint32_t a = 0; a < channels; ++a)
    for (std::uint32_t b = 0; b <= a; ++b) scene.request.entries.push_back({a, b});
  return scene;
}

/// Entries picked from a lower triangle.
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

PlanCase few_entries(const NamedScene& on) {
  return case_of("the rest of the matrix", on.name, Numbers::same, Measure::sample,
                 [scene = on.scene] {
                   const Scene whole = with_whole_matrix(scene);
                   Plan special = plan_of(scene), general = plan_of(whole);
                   special.sampled_single = general.sampled_single = true;
                   special.paths_per_batch = general.paths_per_batch;
                   SampledKernel all = kernel_of(mc::covariance_job(whole, general, seed));
                   all.estimator = picked(all.estimator, scene.request.entries);
                   return std::pair{all, kernel_of(mc::covariance_job(scene, special, seed))};
                 });
}

/// The same phase function as one of the bulk that has no form of its own.
PlanCase bulk_table(const NamedScene& on) {
  return case_of(
      "a table of the phase function", on.name, Numbers::other, Measure::sample,
      [scene = on.scene] {
        Scene table = scene;
        table.scatterer.kind = Scatterer::Kind::other_bulk;
        table.medium.phase = {oracles::henyey_greenstein(scene.scatterer.g), scene.scatterer.g, ""};
        return std::pair{kernel_of(mc::covariance_job(table, plan_of(table), seed)),
                         kernel_of(mc::covariance_job(scene, plan_of(scene), seed + 1))};
      });
}

/// The same medium as two layers, with single scattering by paths in both.
PlanCase equal_layers(const NamedScene& on) {
  return case_of("what varies with depth", on.name, Numbers::other, Measure::sample,
                 [scene = on.scene] {
                   Scene layered = scene;
                   const double half = scene.domain.depth / 2;
                   layered.profile = std::make_shared<const Layers>(
                       std::vector<Material>(2, {scene.scatterer, scene.medium}),
                       std::vector<double>{half, half});
                   Plan special = plan_of(scene);
                   special.sampled_single = true;
                   return std::pair{kernel_of(mc::covariance_job(layered, plan_of(layered), seed)),
                                    kernel_of(mc::covariance_job(scene, special, seed + 1))};
                 });
}

/// Point sources and near sensors, in a field of hardly any gradient.
PlanCase curved_rays(const NamedScene& on) {
  return case_of("curved rays", on.name + ", near ends", Numbers::other, Measure::sample,
                 [scene = on.scene]() mutable {
                   scene.request = full_request({point_source({0, -4}), point_source({0.5, -4})},
                                                {near_sensor({0, 14}), near_sensor({8, 14})});
                   Scene graded = scene;
                   graded.index.emplace();
                   graded.index->kind = IndexField::Kind::linear;
                   graded.index->slope = {0, 1e-9};
                   return std::pair{kernel_of(mc::covariance_job(graded, plan_of(graded), seed)),
                                    kernel_of(mc::covariance_job(scene, plan_of(scene), seed + 1))};
                 });
}

/// A map of density 1, with single scattering by paths in both.
PlanCase even_map(const NamedScene& on) {
  return case_of("a density map", on.name, Numbers::other, Measure::sample, [scene = on.scene] {
    constexpr std::size_t rows = 8, columns = 16;
    Scene mapped = scene;
    mapped.profile =
        std::make_shared<const CellDensity>(scene.domain, Material{scene.scatterer, scene.medium},
                                            rows, std::vector<double>(rows * columns, 1));
    Plan special = plan_of(scene);
    special.sampled_single = true;
    return std::pair{kernel_of(mc::covariance_job(mapped, plan_of(mapped), seed)),
                     kernel_of(mc::covariance_job(scene, special, seed + 1))};
  });
}

/// By scatterers that do not shift the wavenumber.
PlanCase refraction(const NamedScene& on) {
  return case_of(
      "refraction of the mean field", on.name, Numbers::other, Measure::sample, [scene = on.scene] {
        Scene refracted = scene;
        refracted.index.emplace().kind = IndexField::Kind::mean_field;
        return std::pair{kernel_of(mc::covariance_job(refracted, plan_of(refracted), seed)),
                         kernel_of(mc::covariance_job(scene, plan_of(scene), seed + 1))};
      });
}

/// Scatterers that flow by nothing beside diffusing.
PlanCase flow(const NamedScene& on) {
  return case_of(
      "flow", on.name + ", 8 delays", Numbers::same, Measure::sample, [scene = on.scene] {
        const Plan plan = plan_of(scene);
        const std::vector<double> times = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2};
        return std::pair{
            kernel_of(mc::delay_job(scene, plan, times, seed, {.velocity = {1e-300, 0}}).field),
            kernel_of(mc::delay_job(scene, plan, times, seed).field)};
      });
}

PlanCase derivatives(const NamedScene& on) {
  return case_of("derivatives", on.name, Numbers::same, Measure::sample, [scene = on.scene] {
    const Plan plan = mc::gradient_plan(scene, mc::ReversedPaths::no);
    return std::pair{kernel_of(mc::gradient_job(scene, plan, seed).field),
                     kernel_of(mc::covariance_job(scene, plan, seed))};
  });
}

PlanCase delays(const NamedScene& on) {
  return case_of("8 delays", on.name, Numbers::same, Measure::sample, [scene = on.scene] {
    const Plan plan = plan_of(scene);
    const std::vector<double> times = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2};
    return std::pair{kernel_of(mc::delay_job(scene, plan, times, seed).field),
                     kernel_of(mc::covariance_job(scene, plan, seed))};
  });
}

PlanCase frequencies(const NamedScene& on) {
  return case_of("8 frequency shifts", on.name, Numbers::same, Measure::sample, [scene = on.scene] {
    const std::vector<double> shifts = {1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2};
    const Plan plan = mc::frequency_plan(scene, mc::ReversedPaths::automatic);
    return std::pair{kernel_of(mc::frequency_job(scene, plan, shifts, seed).field),
                     kernel_of(mc::covariance_job(scene, plan, seed))};
  });
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
  const auto standard = standard_scenes();
  const NamedScene points{"box_points, 64 tilts", standard[0].scene};
  const NamedScene slab{"slab_hg g 0, 64 tilts", standard[4].scene};
  const NamedScene forward{"slab_hg g 0.9, 64 tilts", standard[5].scene};
  const NamedScene around{"box_points, 64 intensities",
                          with_request(points.scene, intensity_request({0}, views_around(64)))};
  const NamedScene full{"box_points, full, 128 channels",
                        with_request(points.scene, full_request({0, 0.1}, views_around(64)))};
  constexpr auto same = Numbers::same, other = Numbers::other;
  constexpr auto sample = Measure::sample, error = Measure::error;
  return {
      flag("anisotropy", points, other, sample,
           [](Plan& plan) { plan.phase = Plan::Phase::henyey_greenstein; }),
      flag("a tabulated amplitude", points, other, sample,
           [](Plan& plan) { plan.phase = Plan::Phase::tabulated; }),
      flag("absorption", points, other, sample, [](Plan& plan) { plan.weighted = true; }),
      flag("reversed paths", slab, other, sample, [](Plan& plan) { plan.reversed = true; }),
      flag("phases", around, same, sample, [](Plan& plan) { plan.phases = true; }),
      few_entries(points),
      flag("updates entry by entry", full, same, sample, [](Plan& plan) { plan.rank_k = false; }),
      flag("paths of one scatterer", points, other, error,
           [](Plan& plan) { plan.sampled_single = true; }),
      flag("scores that promise little", forward, other, error,
           [](Plan& plan) { plan.score_level = 0; }),
      bulk_table(forward),
      equal_layers(points),
      equal_layers(forward),
      even_map(points),
      curved_rays(points),
      refraction(slab),
      derivatives(forward),
      delays(around),
      flow(around),
      frequencies(around),
  };
}

}  // namespace flatspeckle::bench

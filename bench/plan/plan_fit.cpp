// Comparisons for fits of media to measurements.

#include "bench/plan/plan_timing.h"
#include "bench/scenes/synthetic_slab.h"
#include "mc/fit/model/slab_model.h"
#include "mc/fit/task/fit_data.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/gradient.h"

namespace flatspeckle::bench {

namespace {

/// Curves measured on a slab, and the media of their model.
struct Curves {
  std::vector<mc::Curve> curves;
  mc::Media media;

  explicit Curves(const mc::FitTask& task)
      : curves(mc::curves_of(task)), media(mc::media_at(task, mc::middle(task))) {}

  std::vector<Complex> joint() const {
    const auto values = mc::SlabModel(curves, media).values(media);
    return {values.begin(), values.end()};
  }
  std::vector<Complex> one_by_one() const {
    std::vector<Complex> all;
    for (std::size_t i = 0; i < curves.size(); ++i) {
      const mc::Media medium{media[i]};
      const auto values = mc::SlabModel({curves[i]}, medium).values(medium);
      all.insert(all.end(), values.begin(), values.end());
    }
    return all;
  }
};

/// Compares one transport solution per curve with one solution shared by all detection directions.
TwoAlternatives curves_one_by_one(bool) {
  const Curves of(slab_task(standard_slab().exact()));
  return {[=] { return of.one_by_one(); }, [=] { return of.joint(); }};
}

/// Compares transport with and without reversed paths, for a detection direction far from
/// backscattering.
TwoAlternatives reversed_paths(bool) {
  const Scene scene = Curves(slab_task(standard_slab().exact())).media[2].scene;
  const auto covariance = [=](bool reversed) {
    return mc::slab_covariance(scene, reversed, {1e-4}).value;
  };
  return {[=] { return covariance(true); }, [=] { return covariance(false); }};
}

SceneSpec slab_of(double optical_depth) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 2000;
  spec.scatterer = "hg";
  spec.g = 0.8;
  spec.optical_depth = optical_depth;
  spec.view_angles = {-0.6, 0.2, 0.5};
  return spec;
}

/// Estimates the derivative with respect to the optical depth by the difference of two runs with
/// different random numbers.
SampledKernel difference_of_runs() {
  constexpr double optical_depth = 4, step = 0.2;
  const auto job = [&](double at, std::uint64_t seed) {
    const Scene scene = make_scene(slab_of(at));
    return mc::covariance_job(scene, mc::make_plan(scene, mc::ReversedPaths::no), seed);
  };
  const FieldJob above = job(optical_depth + step, 2), below = job(optical_depth - step, 3);
  const std::size_t half = above.batches.size;
  return {2 * half, above.batches.samples_per_batch,
          [=](std::uint64_t number, std::span<Complex> sums) {
            above.batches.run(number, sums.first(half));
            below.batches.run(number, sums.last(half));
          },
          [=](double samples, std::span<const Complex> sums) {
            auto derivatives = above.covariance(samples, sums.first(half));
            const auto low = below.covariance(samples, sums.last(half));
            for (std::size_t i = 0; i < derivatives.size(); ++i)
              derivatives[i] = (derivatives[i] - low[i]) / (2 * step);
            return derivatives;
          }};
}

/// Estimates the derivative with respect to the optical depth from the paths of one run.
SampledKernel derivatives_of_run() {
  const Scene scene = make_scene(slab_of(4));
  const auto job = mc::gradient_job(scene, mc::gradient_plan(scene, mc::ReversedPaths::no), 1);
  return {
      job.field.batches.size, job.field.batches.samples_per_batch, job.field.batches.run,
      [=, entries = scene.request.entries.size()](double samples, std::span<const Complex> sums) {
        const auto all = job.gradient(samples, sums);
        return std::vector<Complex>(all.end() - static_cast<std::ptrdiff_t>(entries), all.end());
      }};
}

}  // namespace

std::vector<PlanCase> fit_plan_cases() {
  constexpr double rounding = 1e-11, negligible = 2e-3;
  return {
      case_of_values({"fit", "curves one by one", "slab, 4 curves and transmittance", "model"},
                     rounding, curves_one_by_one),
      case_of_values({"fit", "reversed paths", "slab, a view in reflection", "model"}, negligible,
                     reversed_paths),
      case_of_samples({"fit", "differences of two runs", "slab, intensities by optical depth", ""},
                      Draws::other, Measure::error, []() -> TwoKernels {
                        return {difference_of_runs(), derivatives_of_run()};
                      })};
}

}  // namespace flatspeckle::bench

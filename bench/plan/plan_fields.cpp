#include <algorithm>
#include <complex>
#include <span>

#include "bench/plan/plan_timing.h"
#include "bench/scenes/standard_scenes.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::bench {

namespace {

constexpr std::uint64_t seed = 1, paths_per_field = 500;
constexpr int views = 256;

/// Returns the scene box_points with all pairs of its detection directions.
Scene viewed_scene() {
  std::vector<View> fan;
  for (int v = 0; v < views; ++v) fan.push_back(far_view(0.2 + 0.8 * v / views));
  Scene scene = box_points();
  scene.request = full_request({0}, fan);
  return scene;
}

mc::Plan plan_of(const Scene& scene) {
  return mc::make_plan(scene, mc::ReversedPaths::no);
}

/// Returns the sums of the covariance over the first `batches` batches of paths.
GroupedSums covariance_sums(const FieldJob& job, int batches) {
  GroupedSums sums(job.batches.size);
  std::vector<Complex> batch(job.batches.size);
  for (int b = 0; b < batches; ++b) {
    std::fill(batch.begin(), batch.end(), 0);
    job.batches.run(sums.batches(), batch);
    sums.add(job.batches.samples_per_batch, batch);
  }
  return sums;
}

FieldJob job_of(const Scene& scene) {
  return mc::covariance_job(scene, plan_of(scene), seed);
}

mc::FieldDraw drawn_from(const FieldJob& job, const GroupedSums& sums) {
  const auto lower = job.covariance(sums.total_samples(), sums.total());
  return mc::fields_from_covariance(mc::CovarianceFactor(views, lower), seed);
}

mc::FieldDraw drawn_by_paths(Scene scene) {
  scene.request = mc::field_request(scene.request.lights, scene.request.views);
  return mc::fields_by_paths(scene, plan_of(scene), seed + 1, paths_per_field);
}

/// Makes a kernel that samples one field per batch and estimates the intensity in every detection
/// direction.
SampledKernel kernel_of(const mc::FieldDraw& draw) {
  return {views, 1,
          [draw](std::uint64_t number, std::span<Complex> sums) {
            std::vector<Complex> field(views);
            std::vector<double> intensity(views);
            draw(number, field, intensity);
            for (int v = 0; v < views; ++v) sums[v] += std::norm(field[v]);
          },
          [](double samples, std::span<const Complex> sums) {
            Complex mean = 0;
            for (const Complex& sum : sums) mean += sum / (samples * views);
            return std::vector<Complex>{mean};
          }};
}

/// Compares the time per field when many fields are sampled. The covariance is then estimated only
/// once, and its time is not counted.
TwoKernels light_paths_of_each_field() {
  const Scene scene = viewed_scene();
  const FieldJob job = job_of(scene);
  return {kernel_of(drawn_by_paths(scene)), kernel_of(drawn_from(job, covariance_sums(job, 32)))};
}

/// Compares the time per field when only two fields are sampled. It includes estimating their
/// covariance to about 2 %.
void covariance_of_few_fields(PlanRow& row, double cpu_seconds) {
  constexpr int fields = 2, batches = 8;
  const Scene scene = viewed_scene();
  const FieldJob job = job_of(scene);
  const auto by_paths = drawn_by_paths(scene);
  std::vector<Complex> field(views);
  std::vector<double> intensity(views);
  const auto draw = [&](const mc::FieldDraw& from) {
    for (std::uint64_t number = 0; number < fields; ++number) from(number, field, intensity);
  };
  compare_times(row, timed([&] { draw(drawn_from(job, covariance_sums(job, batches))); }),
                timed([&] { draw(by_paths); }), cpu_seconds);
  row.general_s /= fields;
  row.special_s /= fields;
  const auto mean_intensity = [&](double samples, std::span<const Complex> sums) {
    const auto lower = job.covariance(samples, sums);
    Complex mean = 0;
    for (std::size_t v = 0; v < views; ++v) mean += lower[v * (v + 1) / 2 + v] / double{views};
    return std::vector<Complex>{mean};
  };
  GroupedSums sums(views);
  const SampledKernel kernel = kernel_of(by_paths);
  for (std::uint64_t number = 0; number < 64; ++number) {
    std::vector<Complex> batch(views);
    kernel.run(number, batch);
    sums.add(1, batch);
  }
  compare_estimates(row, jackknife(covariance_sums(job, 32), mean_intensity),
                    jackknife(sums, kernel.estimator));
}

}  // namespace

std::vector<PlanCase> field_plan_cases() {
  const std::string scene = "box_points, 256 views";
  return {
      case_of_samples({"fields", "light paths of each field", scene + ", many fields", "field"},
                      Draws::other, Measure::sample, light_paths_of_each_field),
      named({"fields", "the covariance", scene + ", 2 fields", "field"}, covariance_of_few_fields)};
}

}  // namespace flatspeckle::bench

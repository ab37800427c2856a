#include "mc/paths/speckle/field_drawing.h"

#include <algorithm>

#include "core/run/interrupt.h"
#include "flatland/request/triangle.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/field_statistics.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// Siegert's relation is asked of covariances of so many views at the most, and of so many paths:
/// their noise adds its square, about 1e-3, to the curve.
constexpr std::size_t most_siegert_views = 512;
constexpr std::uint64_t siegert_paths = 20000;

/// Few and long: the runs have a fixed length, and a batch costs a pass over the covariance.
constexpr std::uint64_t covariance_batches = 128;

/// One run after the other, and what they cost.
class FieldDrawing {
 public:
  FieldDrawing(const Scene& scene, const DrawingSettings& settings)
      : scene_(scene), settings_(settings), plan_(make_plan(scene, settings.reversed)) {}

  std::optional<DrawnFields> draw(const FieldDemand& demand,
                                  const std::function<void(const DrawingPlan&)>& planned) {
    const RunState survey = run("survey", survey_job(scene_, plan_, settings_.seed), survey_paths);
    if (interrupted()) return std::nullopt;
    drawn_.plan = make_field_plan(scene_, read_survey(survey.sums), demand);
    planned(drawn_.plan);
    const bool by_paths = drawn_.plan.method == FieldMethod::paths;
    const auto source =
        by_paths ? fields_by_paths(scene_, plan_, settings_.seed, drawn_.plan.paths_per_field)
                 : from_covariance();
    if (interrupted()) return std::nullopt;
    const RunState fields = run("fields", field_job(source, demand.fields), demand.fields);
    if (interrupted()) return std::nullopt;
    if (by_paths) drawn_.intensity = jackknife(fields.sums, sample_mean);
    if (by_paths && siegert_applies()) covariance({scene_.request.lights.front()}, siegert_paths);
    if (interrupted()) return std::nullopt;
    return std::move(drawn_);
  }

 private:
  RunState run(const std::string& label, const BatchJob& job, std::uint64_t samples) {
    RunState state;
    const StopRule stop{samples, std::nullopt, std::nullopt};
    run_batches(job, {stop, settings_.threads, label, {}}, state);
    drawn_.wall_s += state.wall_s;
    drawn_.cpu_s += state.cpu_s;
    return state;
  }

  bool siegert_applies() const {
    return equal_step(scene_.request.views) && scene_.request.views.size() <= most_siegert_views;
  }

  /// Of all views under these lights, the first of which is the scene's first.
  std::pair<FieldJob, RunState> covariance(const Lights& lights, std::uint64_t paths) {
    Scene scene = scene_;
    scene.request = full_request(lights, scene_.request.views);
    Plan plan = make_plan(scene, settings_.reversed);
    plan.paths_per_batch = (paths + covariance_batches - 1) / covariance_batches;
    FieldJob job = covariance_job(scene, plan, settings_.seed);
    job.batches.relative_error = BatchJob().relative_error;
    RunState state = run("covariance", job.batches, paths);
    if (siegert_applies())
      drawn_.siegert = siegert_relation(state.sums, job.covariance, scene_.request.views.size());
    return {job, std::move(state)};
  }

  FieldDraw from_covariance() {
    const auto [job, state] = covariance(scene_.request.lights, drawn_.plan.covariance_paths);
    const std::size_t channels = scene_.request.channels.size();
    drawn_.intensity = jackknife(
        state.sums, [&, estimator = job.covariance](double samples, std::span<const Complex> sums) {
          return diagonal(estimator(samples, sums), channels);
        });
    const auto lower = job.covariance(state.sums.total_samples(), state.sums.total());
    return fields_from_covariance(CovarianceFactor(channels, lower), settings_.seed);
  }

  /// A batch is a field; its sums are the intensities that it was drawn with.
  BatchJob field_job(const FieldDraw& draw, std::uint64_t fields) {
    const std::size_t channels = scene_.request.channels.size();
    drawn_.field.resize(fields * channels);
    BatchJob job;
    job.size = channels;
    job.run = [this, draw, channels](std::uint64_t number, std::span<Complex> sums) {
      std::vector<double> intensity(channels);
      draw(number, std::span(drawn_.field).subspan(number * channels, channels), intensity);
      std::copy(intensity.begin(), intensity.end(), sums.begin());
    };
    return job;
  }

  const Scene& scene_;
  const DrawingSettings& settings_;
  Plan plan_;
  DrawnFields drawn_;
};

}  // namespace

std::optional<DrawnFields> draw_fields(const Scene& scene, const FieldDemand& demand,
                                       const DrawingSettings& settings,
                                       const std::function<void(const DrawingPlan&)>& planned) {
  return FieldDrawing(scene, settings).draw(demand, planned);
}

}  // namespace flatspeckle::mc

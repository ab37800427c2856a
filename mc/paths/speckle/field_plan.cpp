#include "mc/paths/speckle/field_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/address_space.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// Below every other use of a seed's light paths: batches that no field has as its number.
constexpr std::uint64_t first_survey_batch = std::uint64_t{1} << 62;
constexpr std::uint64_t survey_paths_per_batch = 64;

/// Sums per channel of a batch: its intensity and the sum of the squares of its contributions'.
class SurveyAccumulator : public Accumulator {
 public:
  explicit SurveyAccumulator(std::size_t channels) : intensity_(channels), squares_(channels) {}

  void add(double weight, std::span<const Complex> field) override {
    ++contributions_;
    for (std::size_t c = 0; c < field.size(); ++c) {
      const double intensity = weight * std::norm(field[c]);
      intensity_[c] += intensity;
      squares_[c] += intensity * intensity;
    }
  }

  /// [channel] intensity and its square (of the batch), [channel] squares; contributions.
  void finish(std::span<Complex> sums) const {
    const std::size_t n = intensity_.size();
    for (std::size_t c = 0; c < n; ++c) {
      sums[c] += Complex(intensity_[c], intensity_[c] * intensity_[c]);
      sums[n + c] += squares_[c];
    }
    sums[2 * n] += contributions_;
  }

 private:
  std::vector<double> intensity_, squares_;
  double contributions_ = 0;
};

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0;
  for (double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

std::uint64_t rounded_up(double number, double least) {
  return static_cast<std::uint64_t>(std::ceil(std::max(number, least)));
}

/// About twenty copies of the sums are held while they are estimated, as full_request has it.
bool covariance_fits(double channels) {
  return 10.0 * sizeof(Complex) * channels * channels < 0.8 * usable_memory();
}

/// In complex multiply-adds of a plain loop: of a path's step, that of walking it and of each end
/// factor is about that of ten; zherk and Cholesky do theirs four times as fast, and products with
/// a factor too large for the caches twice as fast (measured).
void set_costs(DrawingPlan& plan, const Scene& scene, double contributions, double fields) {
  constexpr double end_factor = 10, blas_speed = 4, product_speed = 2;
  const auto n = static_cast<double>(scene.request.channels.size());
  const auto ends = static_cast<double>(scene.request.lights.size() + scene.request.views.size());
  const double path = contributions * (end_factor * (1 + ends) + n);
  plan.paths_cost = fields * static_cast<double>(plan.paths_per_field) * (path + contributions * n);
  plan.covariance_cost = static_cast<double>(plan.covariance_paths) *
                             (path + contributions * n * n / (2 * blas_speed)) +
                         n * n * n / (3 * blas_speed) + fields * n * n / product_speed;
  if (!covariance_fits(n)) plan.covariance_cost = std::numeric_limits<double>::infinity();
}

}  // namespace

BatchJob survey_job(const Scene& scene, const Plan& general, std::uint64_t seed) {
  Plan plan = plan_for_fields(general);
  plan.paths_per_batch = survey_paths_per_batch;
  const std::size_t channels = scene.request.channels.size();
  BatchJob job;
  job.size = 2 * channels + 1;
  job.samples_per_batch = static_cast<double>(survey_paths_per_batch);
  job.run = [batches = path_batches(scene, plan, seed), channels](std::uint64_t number,
                                                                  std::span<Complex> sums) {
    SurveyAccumulator accumulator(channels);
    batches(first_survey_batch + number, accumulator);
    accumulator.finish(sums);
  };
  return job;
}

PathSurvey read_survey(const GroupedSums& sums) {
  const std::size_t channels = (sums.size() - 1) / 2;
  const auto total = sums.total();
  const auto paths = sums.total_samples(), batches = static_cast<double>(sums.batches());
  const double paths_per_batch = paths / batches;
  PathSurvey survey;
  survey.contributions = total[2 * channels].real() / paths;
  for (std::size_t c = 0; c < channels; ++c) {
    const double intensity = total[c].real() / paths;
    survey.intensity.push_back(intensity);
    if (intensity == 0) {
      survey.spread.push_back(0);
      survey.excess.push_back(0);
      continue;
    }
    const double batch_mean = total[c].real() / batches, square_mean = total[c].imag() / batches;
    const double variance = (square_mean - batch_mean * batch_mean) * batches / (batches - 1);
    const double unit = intensity * intensity;
    const double spread = variance / paths_per_batch / unit;
    survey.spread.push_back(spread);
    // Given the contributions I_j, E|u|^4 over their phases is 2 (sum I_j)^2 - sum I_j^2.
    survey.excess.push_back(2 * spread - total[channels + c].real() / paths / unit);
  }
  return survey;
}

DrawingPlan make_field_plan(const Scene& scene, const PathSurvey& survey,
                            const FieldDemand& demand) {
  constexpr double accepted_excess = 0.01, fewest_paths = 100, most_paths = 1e15;
  DrawingPlan plan;
  const double excess = largest_magnitude(survey.excess);
  plan.paths_per_field =
      demand.paths_per_field.value_or(rounded_up(excess / accepted_excess, fewest_paths));
  const double asked =
      mean(survey.spread) / (demand.covariance_error * demand.covariance_error);
  plan.covariance_paths = rounded_up(std::min(asked, most_paths), 10 * fewest_paths);
  plan.excess = excess / static_cast<double>(plan.paths_per_field);
  set_costs(plan, scene, survey.contributions, static_cast<double>(demand.fields));
  plan.method = demand.method;
  if (plan.method == FieldMethod::automatic)
    plan.method =
        plan.covariance_cost < plan.paths_cost ? FieldMethod::covariance : FieldMethod::paths;
  if (plan.method == FieldMethod::covariance && asked > most_paths)
    throw InputError("target_error", demand.covariance_error,
                     "asks for " + number_text(asked) + " paths, at most " + number_text(most_paths) +
                         " are taken");
  return plan;
}

std::string DrawingPlan::describe() const {
  std::ostringstream text;
  text.precision(3);
  if (method == FieldMethod::paths)
    text << "fields by paths, " << paths_per_field << " each (excess kurtosis " << excess << ")";
  else
    text << "fields from the covariance of " << covariance_paths << " paths, Cholesky";
  text << "; multiply-adds: by paths " << paths_cost << ", from the covariance ";
  if (std::isfinite(covariance_cost))
    text << covariance_cost;
  else
    text << "more than the memory holds";
  return text.str();
}

}  // namespace flatspeckle::mc

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

/// Number of the first batch of the pilot run (the survey). It is larger than the number of any
/// field, so that the pilot run shares no random numbers with other uses of the seed.
constexpr std::uint64_t first_survey_batch = std::uint64_t{1} << 62;
constexpr std::uint64_t survey_paths_per_batch = 64;
constexpr std::size_t surveyed_pixels = 8;  ///< along each side of an image

/// Sums over the contributions of a batch, for each channel: of their intensities, and of their
/// squared intensities.
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

  /// Adds the batch to the sums. These are, for each channel, the intensity of the batch (real
  /// part) and the square of this intensity (imaginary part); then, for each channel, the sum of
  /// the squared intensities of the contributions; then the number of contributions.
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

/// Passes the images of fields on a pupil to another accumulator.
class ImagedAccumulator : public Accumulator {
 public:
  ImagedAccumulator(const LensImage& lens, std::size_t lights, std::size_t channels,
                    Accumulator& images)
      : lens_(lens), lights_(lights), image_(channels), images_(images) {}

  void add(double weight, std::span<const Complex> field) override {
    const std::size_t views = field.size() / lights_, pixels = image_.size() / lights_;
    for (std::size_t i = 0; i < lights_; ++i)
      lens_.form(field.subspan(i * views, views), std::span(image_).subspan(i * pixels, pixels));
    images_.add(weight, image_);
  }

 private:
  const LensImage& lens_;
  std::size_t lights_;
  std::vector<Complex> image_;
  Accumulator& images_;
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

/// Whether a full covariance fits into memory. Its estimation requires memory for about twenty
/// copies of the lower triangle, as full_request() also assumes.
bool covariance_fits(double channels) {
  return 10.0 * sizeof(Complex) * channels * channels < 0.8 * usable_memory();
}

/// Sets the costs, in units of one complex multiply-add in a plain loop (measured). A step of a
/// path costs about ten units, and so does each endpoint factor. The operations of zherk and
/// Cholesky are four times as fast as the loop. Products with a Cholesky factor, which is too large
/// for the caches, are twice as fast as the loop.
void set_costs(DrawingPlan& plan, const Scene& scene, double contributions, double fields) {
  constexpr double end_factor = 10, blas_speed = 4, product_speed = 2;
  const auto n = static_cast<double>(scene.request.channels.size());
  const auto endpoints =
      static_cast<double>(scene.request.lights.size() + scene.request.views.size());
  const double path = contributions * (end_factor * (1 + endpoints) + n);
  plan.paths_cost = fields * static_cast<double>(plan.paths_per_field) * (path + contributions * n);
  plan.covariance_cost = static_cast<double>(plan.covariance_paths) *
                             (path + contributions * n * n / (2 * blas_speed)) +
                         n * n * n / (3 * blas_speed) + fields * n * n / product_speed;
  if (!covariance_fits(n)) plan.covariance_cost = std::numeric_limits<double>::infinity();
}

}  // namespace

BatchJob survey_job(const Scene& scene, const Plan& general, std::uint64_t seed,
                    const std::optional<LensPlane>& image) {
  Plan plan = plan_for_fields(general);
  plan.paths_per_batch = survey_paths_per_batch;
  std::optional<LensImage> lens;
  std::size_t channels = scene.request.channels.size();
  if (image) {
    LensPlane few = *image;
    few.pixels = std::min(image->pixels, surveyed_pixels);
    lens.emplace(scene.request.camera.value(), few, scene.k);
    channels = scene.request.lights.size() * few.pixels * few.pixels;
  }
  BatchJob job;
  job.size = 2 * channels + 1;
  job.samples_per_batch = static_cast<double>(survey_paths_per_batch);
  job.run = [batches = path_batches(scene, plan, seed), channels, lens,
             lights = scene.request.lights.size()](std::uint64_t number, std::span<Complex> sums) {
    SurveyAccumulator accumulator(channels);
    if (lens) {
      ImagedAccumulator imaged(*lens, lights, channels, accumulator);
      batches(first_survey_batch + number, imaged);
    } else {
      batches(first_survey_batch + number, accumulator);
    }
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
    // For given intensities I_j of the contributions, E|u|^4 over random phases is 2 (sum I_j)^2 -
    // sum I_j^2.
    survey.excess.push_back(2 * spread - total[channels + c].real() / paths / unit);
  }
  return survey;
}

Plan plan_of_fields(const Scene& scene, ReversedPaths reversed, bool is_image) {
  Plan plan = make_plan(scene, reversed);
  plan.weighted = plan.weighted || (is_image && scene.medium.mu_s > 0);
  return plan;
}

DrawingPlan make_field_plan(const Scene& scene, const PathSurvey& survey,
                            const FieldDemand& demand) {
  constexpr double accepted_excess = 0.01, fewest_paths = 100, most_paths = 1e15;
  DrawingPlan plan;
  const double excess = largest_magnitude(survey.excess);
  plan.paths_per_field =
      demand.paths_per_field.value_or(rounded_up(excess / accepted_excess, fewest_paths));
  const double required_paths =
      mean(survey.spread) / (demand.covariance_error * demand.covariance_error);
  plan.covariance_paths = rounded_up(std::min(required_paths, most_paths), 10 * fewest_paths);
  plan.excess = excess / static_cast<double>(plan.paths_per_field);
  set_costs(plan, scene, survey.contributions, static_cast<double>(demand.fields));
  plan.method = demand.method;
  if (plan.method == FieldMethod::automatic)
    plan.method = plan.covariance_cost < plan.paths_cost && !demand.requires_paths()
                      ? FieldMethod::covariance
                      : FieldMethod::paths;
  if (plan.method == FieldMethod::covariance && required_paths > most_paths)
    throw InputError("target_error", demand.covariance_error,
                     "requires " + number_text(required_paths) + " paths, above the limit of " +
                         number_text(most_paths) + "; take a larger error");
  return plan;
}

std::string DrawingPlan::describe() const {
  std::ostringstream text;
  text.precision(3);
  if (method == FieldMethod::paths)
    text << "fields by paths, " << paths_per_field << " each (excess kurtosis " << excess << ")";
  else
    text << "fields from the covariance of " << covariance_paths << " paths, Cholesky";
  if (method == FieldMethod::paths && camera)
    text << "; camera sums with " << camera->nodes << "^2 nodes, kernels of " << camera->width
         << " points, error " << 100 * camera->error << " %";
  text << "; multiply-adds: by paths " << paths_cost << ", from the covariance ";
  if (std::isfinite(covariance_cost))
    text << covariance_cost;
  else
    text << "does not fit into memory";
  return text.str();
}

}  // namespace flatspeckle::mc

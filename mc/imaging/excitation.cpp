#include "mc/imaging/excitation.h"

#include <numbers>
#include <numeric>
#include <utility>

#include "core/run/interrupt.h"
#include "flatland/request/triangle.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// What makes points shine shares no random numbers with their fields and the camera.
std::uint64_t seed_of_excitation(std::uint64_t seed) {
  return seed ^ 0x9e3779b97f4a7c15U;
}

/// A plane wave from the other side of the box, and sensors where the points are.
CovarianceRequest at_points(const LineScene& line) {
  const Lights light{plane_wave(line.object_depth < 0 ? std::numbers::pi : 0)};
  std::vector<View> views;
  for (const double x : line.object.x) views.push_back(near_sensor({x, line.object_depth}));
  return full_request(light, std::move(views));
}

std::vector<double> correlations(std::span<const Complex> lower, std::size_t points) {
  std::vector<double> pairs;
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t j = i + 1; j < points; ++j)
      pairs.push_back(std::norm(lower[triangle_entry(j, i)]) /
                      (lower[triangle_entry(i, i)].real() * lower[triangle_entry(j, j)].real()));
  return pairs;
}

BrightnessDraw brightness_by(const FieldDraw& fields, std::size_t frames, std::size_t points,
                             double mean) {
  return [=](std::uint64_t medium) {
    std::vector<double> brightness(frames * points);
    std::vector<Complex> field(points);
    std::vector<double> intensity(points);
    for (std::size_t f = 0; f < frames; ++f) {
      fields(medium * frames + f, field, intensity);
      for (std::size_t n = 0; n < points; ++n)
        brightness[f * points + n] = std::norm(field[n]) / mean;
    }
    return brightness;
  };
}

}  // namespace

BrightnessDraw random_subsets(std::size_t frames, std::size_t points, double lit,
                              std::uint64_t seed) {
  return [=](std::uint64_t medium) {
    RandomStream random(seed_of_excitation(seed), static_cast<std::uint64_t>(Stream::camera),
                        medium);
    std::vector<double> brightness(frames * points);
    for (double& each : brightness) each = random.uniform() < lit ? 1 : 0;
    return brightness;
  };
}

std::optional<Excitation> speckle_excitation(Scene medium, const LineScene& line,
                                             const ExcitationTask& task) {
  medium.request = at_points(line);
  const std::uint64_t seed = seed_of_excitation(task.seed);
  const FieldJob job = covariance_job(medium, make_plan(medium, ReversedPaths::automatic), seed);
  RunState state;
  run_batches(job.batches,
              {{task.paths, std::nullopt, std::nullopt}, task.threads, "excitation", {}}, state);
  if (interrupted()) return std::nullopt;
  const std::size_t points = line.object.x.size();
  const auto lower = job.covariance(state.sums.total_samples(), state.sums.total());
  CovarianceFactor factor(points, lower);
  double mean = 0;
  for (std::size_t n = 0; n < points; ++n) mean += factor.variance(n) / static_cast<double>(points);
  return Excitation{
      brightness_by(fields_from_covariance(std::move(factor), seed), task.frames, points, mean),
      correlations(lower, points)};
}

}  // namespace flatspeckle::mc

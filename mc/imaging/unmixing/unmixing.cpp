#include "mc/imaging/unmixing/unmixing.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "mc/imaging/recovery/frame_statistics.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// [pixel][frame], the mean 1, without the background.
MatrixXd light_of(std::span<const std::vector<double>> frames, double background) {
  MatrixXd light(static_cast<Index>(frames.front().size()), static_cast<Index>(frames.size()));
  for (Index f = 0; f < light.cols(); ++f)
    light.col(f) =
        Eigen::Map<const Eigen::VectorXd>(frames[static_cast<std::size_t>(f)].data(), light.rows());
  const double mean = light.mean();
  if (!(mean > 0)) throw InputError("frames: their mean is not positive");
  return (light.array() * ((1 + background) / mean) - background).matrix();
}

std::size_t sources_of(const UnmixingTask& task, const SourceCount& count, std::size_t frames) {
  if (task.sources > frames)
    throw InputError("points", task.sources,
                     "sources take at least as many frames; there are " + std::to_string(frames));
  constexpr std::size_t most = 64;
  return task.sources > 0 ? task.sources : std::min(count.sources, most);
}

/// The mean over the patterns.
double grain_of_patterns(const MatrixXd& patterns, std::size_t lags) {
  double sum = 0;
  for (Index s = 0; s < patterns.cols(); ++s) {
    const std::vector<double> pattern(patterns.col(s).begin(), patterns.col(s).end());
    sum += frame_statistics(pattern, lags).grain;
  }
  return sum / static_cast<double>(patterns.cols());
}

}  // namespace

LineObject Unmixed::object() const {
  if (places.x.empty()) return {};
  const Eigen::VectorXd mean = factors.brightness.colwise().mean();
  LineObject object;
  for (std::size_t s = 0; s < places.x.size(); ++s)
    if (places.group[s] == 0) {
      object.x.push_back(places.x[s]);
      object.brightness.push_back(mean[static_cast<Index>(s)] / mean.mean());
    }
  return object;
}

Unmixed unmixed(std::span<const std::vector<double>> frames, const UnmixingTask& task) {
  const MatrixXd light = light_of(frames, task.noise.background);
  Unmixed found;
  found.count = source_count(light, task.noise);
  const std::size_t sources = sources_of(task, found.count, frames.size());
  if (sources == 0) return found;
  found.factors = nonnegative_factors(light, {.sources = sources});
  found.grain = grain_of_patterns(found.factors.pattern, task.lags);
  const auto shifts = pattern_shifts(found.factors.pattern, task.lags);
  found.places = source_places(sources, shifts, task.resolution_grains * found.grain);
  return found;
}

}  // namespace flatspeckle::mc

#include "mc/imaging/separation/separation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "core/algebra/dense.h"
#include "core/error.h"
#include "core/numbers/symmetric.h"
#include "core/result/result_group.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/retrieval/picture_statistics.h"

namespace flatspeckle::mc {

const DatasetTable separation_table{
    .name = "sources",
    .rows = {
        {"frame", Data::numbers, "", "1", "number of the frame"},
        {"frame_name", Data::text, "frame", "", "column of the frame"},
        {"pixel", Data::numbers, "", "1", "number of the pixel along the line"},
        {"pattern_row", Data::numbers, "", "1", "row of the frames, if they are pictures"},
        {"pattern_column", Data::numbers, "", "1", "column of the frames, if they are pictures"},
        {"source", Data::numbers, "", "1", "number of the source"},
        {"singular_value", Data::real, "frame", "1",
         "singular values of the frames divided by their mean, largest first; the camera's noise "
         "is whitened if it is known"},
        {"noise_level", Data::real, "", "1",
         "threshold: singular values above it count as sources"},
        {"source_count", Data::count, "", "1", "number of singular values above noise_level"},
        {"factor_residual", Data::real, "", "1",
         "rms residual of the factorisation, divided by the rms of the light"},
        {"invariants/scale", Data::invariant, "", "1",
         "relative change by which a common factor of all brightness would fit the frames best"},
        {"source_pattern", Data::real, "source pixel", "1",
         "speckle pattern of each source, mean 1"},
        {"source_picture", Data::real, "source pattern_row pattern_column", "1",
         "speckle pattern of each source in frames that are pictures, mean 1"},
        {"source_brightness", Data::real, "frame source", "1",
         "brightness in units of the mean of all frames"},
        {"source_x", Data::real, "source", "1",
         "position in pixels from the first source of the group, not mirrored"},
        {"source_y", Data::real, "source", "1",
         "position in rows from the first source of the group, if frames are pictures"},
        {"source_group", Data::count, "source", "1",
         "sources with the same number have known relative positions; 0: the largest group"}}};

void write_separation(ResultFile& file, const std::vector<std::string>& names,
                      const SeparatedSources& found) {
  const ResultGroup root(file, separation_table);
  root.number("frame", names.size());
  root.put("frame_name", names);
  root.put("singular_value", found.count.singular_values);
  root.put("noise_level", found.count.threshold);
  root.put("source_count", static_cast<std::uint64_t>(found.count.sources));
  if (found.places.x.empty()) return;
  root.number("source", found.places.x.size());
  const auto pixels = static_cast<std::size_t>(found.factors.pattern.rows());
  const auto patterns = row_major(found.factors.pattern.transpose());
  if (found.rows > 1) {
    root.number("pattern_row", found.rows);
    root.number("pattern_column", pixels / found.rows);
    root.put("source_picture", patterns);
    root.put("source_y", found.places.y);
  } else {
    root.number("pixel", pixels);
    root.put("source_pattern", patterns);
  }
  root.put("factor_residual", found.factors.residual);
  root.check("invariants/scale", found.factors.scale);
  root.put("source_brightness", row_major(found.factors.brightness));
  root.put("source_x", found.places.x);
  root.put("source_group", column(found.places.group, std::identity()));
}

namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;

/// Returns the variance of the camera's noise in each pixel of each frame.
MatrixXd noise_variances(const MatrixXd& light, const CameraNoise& noise) {
  const double reading = noise.read_noise / noise.photons;
  return ((light.array() + noise.background).max(0.0) / noise.photons + reading * reading).matrix();
}

/// Scales rows and columns of the frames so that the noise in each of them has the mean variance 1.
MatrixXd whitened(const MatrixXd& light, const CameraNoise& noise) {
  constexpr int rounds = 20;
  constexpr double least = 1e-300;
  const MatrixXd variances = noise_variances(light, noise);
  const auto rows = static_cast<double>(light.rows()), columns = static_cast<double>(light.cols());
  ArrayXd of_row = ArrayXd::Ones(light.rows()), of_column = ArrayXd::Ones(light.cols());
  for (int round = 0; round < rounds; ++round) {
    of_row = columns / (variances * of_column.matrix()).array().max(least);
    of_column = rows / (variances.transpose() * of_row.matrix()).array().max(least);
  }
  return of_row.sqrt().matrix().asDiagonal() * light * of_column.sqrt().matrix().asDiagonal();
}

/// Returns the level that the largest singular value of a matrix of white noise of variance 1
/// exceeds with the probability 1/100.
double largest_of_noise(double rows, double columns) {
  constexpr double quantile = 2.02;  // of the Tracy-Widom distribution for real matrices
  const double a = std::sqrt(rows - 0.5), b = std::sqrt(columns - 0.5),
               scale = (a + b) * std::cbrt(1 / a + 1 / b);
  return std::sqrt((a + b) * (a + b) + quantile * scale);
}

/// Returns the threshold for the singular values if the noise is white, with unknown variance. It
/// follows from the median of the singular values. most: smaller side of the matrix; aspect: ratio
/// of the smaller to the larger side.
double from_median(const std::vector<double>& values, std::size_t most, double aspect) {
  const double by = 0.56 * std::pow(aspect, 3) - 0.95 * aspect * aspect + 1.82 * aspect + 1.43;
  return by * values[most / 2];
}

/// Returns the singular values, largest first, from the eigenvalues of matrix^T matrix.
std::vector<double> singular_values(const MatrixXd& matrix) {
  const Eigen::VectorXd squares = symmetric_eigen(matrix.transpose() * matrix).values;
  std::vector<double> values;
  for (Eigen::Index i = squares.size(); i-- > 0;)
    values.push_back(std::sqrt(std::max(squares[i], 0.0)));
  return values;
}

/// Returns the light, [pixel][frame], with mean 1, without the background.
MatrixXd light_of(std::span<const std::vector<double>> frames, double background) {
  MatrixXd light(static_cast<Index>(frames.front().size()), static_cast<Index>(frames.size()));
  for (Index f = 0; f < light.cols(); ++f)
    light.col(f) =
        Eigen::Map<const Eigen::VectorXd>(frames[static_cast<std::size_t>(f)].data(), light.rows());
  const double mean = light.mean();
  if (!(mean > 0)) throw InputError("frames: their mean is not positive");
  return (light.array() * ((1 + background) / mean) - background).matrix();
}

std::size_t sources_of(const SeparationTask& task, const SourceCount& count, std::size_t frames) {
  if (task.sources > frames)
    throw InputError(
        "points", task.sources,
        "the number of sources must not exceed the number of frames, " + std::to_string(frames));
  constexpr std::size_t most = 64;
  return task.sources > 0 ? task.sources : std::min(count.sources, most);
}

/// Returns the mean grain size of the patterns.
double grain_of_patterns(const MatrixXd& patterns, std::size_t lags, std::size_t rows) {
  double sum = 0;
  for (Index s = 0; s < patterns.cols(); ++s) {
    std::vector<double> pattern(patterns.col(s).begin(), patterns.col(s).end());
    if (rows == 1) {
      sum += frame_statistics(pattern, lags).grain;
      continue;
    }
    const Frames frame{rows, pattern.size() / rows, std::move(pattern)};
    sum += picture_statistics(frame, 0, 1, lags, {}).grain;
  }
  return sum / static_cast<double>(patterns.cols());
}

}  // namespace

SourceCount source_count(const MatrixXd& light, const CameraNoise& noise) {
  constexpr double rounding = 1e-6;
  const auto rows = static_cast<double>(light.rows()), columns = static_cast<double>(light.cols());
  const bool known = noise.photons > 0;
  SourceCount count;
  count.singular_values = singular_values(known ? whitened(light, noise) : light);
  const double fewer = std::min(rows, columns), more = std::max(rows, columns);
  count.threshold =
      known ? largest_of_noise(rows, columns)
            : from_median(count.singular_values, static_cast<std::size_t>(fewer), fewer / more);
  count.threshold = std::max(count.threshold, rounding * count.singular_values.front());
  for (const double value : count.singular_values) count.sources += value > count.threshold;
  return count;
}

LineObject SeparatedSources::object() const {
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

SeparatedSources separated_sources(std::span<const std::vector<double>> frames,
                                   const SeparationTask& task) {
  const MatrixXd light = light_of(frames, task.noise.background);
  SeparatedSources found;
  found.count = source_count(light, task.noise);
  const std::size_t sources = sources_of(task, found.count, frames.size());
  if (sources == 0) return found;
  found.factors = nonnegative_factors(light, {.sources = sources});
  found.rows = task.rows;
  found.grain = grain_of_patterns(found.factors.pattern, task.lags, task.rows);
  const auto shifts = pattern_shifts(found.factors.pattern, task.lags, task.rows);
  found.places = source_places(sources, shifts, task.resolution_grains * found.grain);
  return found;
}

}  // namespace flatspeckle::mc

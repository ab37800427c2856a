#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "apps/fit/measurement_file.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/statistics.h"
#include "mc/fit/task/intensity_pairs.h"

namespace flatspeckle::apps {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using mc::Curve;
using mc::Measurement;
using mc::Observable;

struct Nearer {
  bool operator()(double a, double b) const {
    return std::pair(std::abs(a), a) < std::pair(std::abs(b), b);
  }
};

/// Data of a table for one light and one view: the tilts, sorted by magnitude, and the fields or
/// intensities [pattern][tilt].
struct SeenView {
  double light = 0, view = 0;
  std::vector<double> tilts;
  std::vector<Complex> values;
};

/// Data of a table, grouped by light and view. In each group, the values are [pattern][tilt].
class Patterns {
 public:
  Patterns(const std::string& path, const Table& table, const std::vector<Complex>& values)
      : path_(path) {
    const auto lights = column_or(table, "light_angle", 0),
               views = column_or(table, "view_angle", 0), tilts = column_or(table, "tilt", 0),
               patterns = column_or(table, "pattern", 0);
    for (std::size_t row = 0; row < values.size(); ++row) {
      auto& pattern = seen_[{lights[row], views[row]}][patterns[row]];
      if (!pattern.emplace(tilts[row], values[row]).second)
        throw InputError("measurement", path,
                         "row " + std::to_string(row + 1) +
                             " repeats the pattern, view and tilt of another row; leave one out");
    }
  }

  std::vector<SeenView> views() const {
    std::vector<SeenView> found;
    for (const auto& [angles, patterns] : seen_) {
      SeenView& one = found.emplace_back();
      std::tie(one.light, one.view) = angles;
      for (const auto& [tilt, value] : patterns.begin()->second) one.tilts.push_back(tilt);
      for (const auto& [number, pattern] : patterns) add(pattern, one);
    }
    return found;
  }

 private:
  using Pattern = std::map<double, Complex, Nearer>;

  void add(const Pattern& pattern, SeenView& view) const {
    std::vector<double> tilts;
    for (const auto& [tilt, value] : pattern) {
      tilts.push_back(tilt);
      view.values.push_back(value);
    }
    if (tilts != view.tilts)
      throw InputError("measurement", path_, "all patterns of a view must have the same tilts");
  }

  std::string path_;
  std::map<std::pair<double, double>, std::map<double, Pattern>> seen_;
};

void check_columns(const std::string& path, const Table& table,
                   const std::vector<std::string>& values) {
  for (const std::string& name : table.names())
    if (name != "pattern" && name != "light_angle" && name != "view_angle" && name != "tilt" &&
        std::ranges::find(values, name) == values.end())
      throw InputError("measurement", path, "column " + name + ": is not used here; remove it");
  table.column("pattern");
}

/// Returns, for each pair of tilts i >= j, the angles of light and view of both channels of the
/// pair (four numbers). Channel i is the light rotated by tilt i, in the view that matches this
/// rotation.
std::vector<double> matched_pairs(const mc::MovingSpec& scene, const SeenView& seen) {
  mc::MovingSpec tilted = scene;
  tilted.light_angles = {seen.light};
  tilted.view_angles = {seen.view};
  tilted.covariance = "memory_effect";
  tilted.tilts = seen.tilts;
  const CovarianceRequest request = make_request(tilted);
  std::vector<std::pair<double, double>> ends;
  for (std::size_t t = 0; t < seen.tilts.size(); ++t) {
    const Channel channel = request.channels[request.entries[request.tilted_intensity(t, 0)].a];
    ends.emplace_back(request.lights[channel.light].angle, request.views[channel.view].angle);
  }
  std::vector<double> pairs;
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j)
      pairs.insert(pairs.end(), {ends[i].first, ends[i].second, ends[j].first, ends[j].second});
  return pairs;
}

void append(Measurement& to, const Curve& curve, const VectorXd& values, const MatrixXd& errors) {
  const Index before = to.values.size(), size = values.size();
  to.curves.push_back(curve);
  to.values.conservativeResize(before + size);
  to.values.tail(size) = values;
  MatrixXd all = MatrixXd::Zero(before + size, before + size);
  all.topLeftCorner(before, before) = to.covariance;
  all.bottomRightCorner(size, size) = errors;
  to.covariance = all;
}

void append_fields(Measurement& to, const Curve& curve, const std::vector<Complex>& fields,
                   std::size_t channels, bool known_scale) {
  constexpr std::size_t most = 32;
  const std::size_t patterns = fields.size() / channels;
  if (channels > most)
    throw InputError("measurement", to.name,
                     std::to_string(channels) + " fields per pattern: must be at most " +
                         std::to_string(most) + "; give fewer views or tilts");
  if (patterns <= channels)
    throw InputError("measurement", to.name,
                     std::to_string(patterns) + " patterns of " + std::to_string(channels) +
                         " fields: must have more patterns than fields");
  to.samples.push_back({channels, static_cast<double>(patterns), known_scale});
  const MatrixXcd covariance = mc::sample_covariance(fields, channels);
  append(to, curve, mc::packed(covariance), mc::sample_errors(to.samples.back(), covariance));
}

Curve field_curve(const mc::MovingSpec& scene, std::size_t channels) {
  Curve curve{scene, Observable::field_covariance, {}, {}};
  for (std::size_t i = 0; i < channels * channels; ++i) curve.entries.push_back(i);
  curve.abscissa.resize(channels * channels);
  return curve;
}

/// Returns the curve of the intensity correlation C_I over all tilts except the first one, which is
/// 0.
Curve correlation_curve(const mc::MovingSpec& medium, const SeenView& seen) {
  Curve curve{medium, Observable::intensity_correlation, {}, {}};
  curve.scene.light_angles = {seen.light};
  curve.scene.view_angles = {seen.view};
  curve.scene.covariance = "memory_effect";
  curve.scene.tilts.assign(seen.tilts.begin() + 1, seen.tilts.end());
  curve.abscissa = curve.scene.tilts;
  for (std::size_t i = 0; i < curve.abscissa.size(); ++i) curve.entries.push_back(i);
  return curve;
}

}  // namespace

std::vector<double> column_or(const Table& table, const std::string& name, double value) {
  if (!table.has(name)) return std::vector<double>(table.rows(), value);
  const auto values = table.column(name);
  return {values.begin(), values.end()};
}

Measurement measurement_of_fields(const std::string& path, const Table& table,
                                  const mc::MovingSpec& medium) {
  check_columns(path, table, {"field_re", "field_im"});
  const auto real = table.column("field_re"), imaginary = table.column("field_im");
  std::vector<Complex> fields;
  for (std::size_t row = 0; row < table.rows(); ++row)
    fields.emplace_back(real[row], imaginary[row]);
  Measurement found;
  found.name = path;
  for (const SeenView& seen : Patterns(path, table, fields).views()) {
    Curve curve = field_curve(medium, seen.tilts.size());
    curve.scene.covariance = "pairs";
    curve.scene.pairs = matched_pairs(medium, seen);
    append_fields(found, curve, seen.values, seen.tilts.size(), false);
  }
  return found;
}

Measurement measurement_of_intensities(const std::string& path, const Table& table,
                                       const mc::MovingSpec& medium) {
  check_columns(path, table, {"speckle_intensity"});
  std::vector<Complex> intensities;
  for (const double value : table.column("speckle_intensity")) intensities.emplace_back(value);
  Measurement found;
  found.name = path;
  for (const SeenView& seen : Patterns(path, table, intensities).views()) {
    if (seen.tilts.front() != 0)
      throw InputError("measurement", path, "every view must have intensities at tilt 0");
    const std::size_t tilts = seen.tilts.size(), patterns = seen.values.size() / tilts;
    constexpr std::size_t more = 10;
    if (patterns <= tilts + more)
      throw InputError(
          "measurement", path,
          std::to_string(patterns) + " patterns: must be more than the number of tilts plus 10");
    const auto pairs = mc::likeliest_correlations(real_parts(seen.values), tilts);
    append(found, correlation_curve(medium, seen), pairs.values, pairs.covariance);
  }
  return found;
}

Measurement measurement_of_drawn_fields(const std::string& path, const mc::MovingSpec& scene,
                                        const std::vector<Complex>& fields) {
  Measurement found;
  found.name = path;
  found.by_paths = true;
  const std::size_t channels = scene.light_angles.size() * scene.view_angles.size();
  Curve curve = field_curve(scene, channels);
  curve.scene.covariance = "full";
  append_fields(found, curve, fields, channels, true);
  return found;
}

}  // namespace flatspeckle::apps

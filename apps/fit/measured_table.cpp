#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/fit/measurement_file.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "mc/fit/task/curve_values.h"
#include "mc/jobs/contrast.h"

namespace flatspeckle::apps {

namespace {

using Eigen::Index;
using mc::Curve;
using mc::Observable;

/// Names of the columns that contain observables. Fields, the last observable, are left out,
/// because their tables have other columns.
const std::vector<std::string> columns_of_values(mc::observable_words.begin(),
                                                 mc::observable_words.end() - 1);

Observable observable_of(const std::string& path, const Table& table) {
  std::vector<Observable> found;
  for (std::size_t i = 0; i < columns_of_values.size(); ++i)
    if (table.has(columns_of_values[i])) found.push_back(static_cast<Observable>(i));
  if (found.size() != 1)
    throw InputError("measurement", path,
                     "must have one column among " + join_texts(columns_of_values, " ") +
                         ", or field_re and field_im, or speckle_intensity");
  return found.front();
}

/// Variable of a table over which its values are given as a curve.
enum class CurveAxis { none, tilt, delay, exposure, distance };
const std::vector<std::string> axis_words = {"", "tilt", "delay", "exposure", "distance"};

/// Whether the values are those of detectors at distances from a beam.
bool is_at_distances(const Table& table) {
  return table.has("distance");
}

CurveAxis axis_of(const Table& table, Observable observable) {
  if (is_at_distances(table) && observable == Observable::reflectance) return CurveAxis::distance;
  if (is_at_distances(table) && observable <= Observable::intensity_correlation)
    return CurveAxis::delay;
  if (observable == Observable::squared_contrast) return CurveAxis::exposure;
  if (observable > Observable::intensity_correlation) return CurveAxis::none;
  return table.has("delay") ? CurveAxis::delay : CurveAxis::tilt;
}

/// Throws InputError if the table has columns that are not used for this observable and axis.
void check_columns(const std::string& path, const Table& table, Observable observable,
                   CurveAxis axis) {
  const std::string covariance = "covariance_";
  const bool distances = is_at_distances(table) && observable <= Observable::reflectance &&
                         observable != Observable::intensity;
  for (const std::string& name : table.names()) {
    const bool known = name == "error" || name.starts_with(covariance) ||
                       name == mc::observable_words[static_cast<std::size_t>(observable)] ||
                       name == axis_words[static_cast<std::size_t>(axis)] ||
                       (distances ? name == "distance"
                                  : name == "light_angle" || name == "depth" ||
                                        (name == "view_angle" && !mc::is_flux(observable)));
    if (!known)
      throw InputError("measurement", path, "column " + name + ": is not used here; remove it");
  }
}

/// Whether a matrix is symmetric up to rounding errors.
bool is_symmetric(const Eigen::MatrixXd& matrix) {
  double largest = 0, skew = 0;
  for (Index i = 0; i < matrix.rows(); ++i)
    for (Index j = 0; j < matrix.cols(); ++j) {
      largest = std::max(largest, std::abs(matrix(i, j)));
      skew = std::max(skew, std::abs(matrix(i, j) - matrix(j, i)));
    }
  return skew <= 1e-9 * largest;
}

Eigen::MatrixXd covariance_of(const std::string& path, const Table& table) {
  if (table.has("error")) {
    const auto errors = table.column("error");
    if (table.has("covariance_1"))
      throw InputError("measurement", path,
                       "must have a column error or columns covariance_1 ..., not both");
    return independent_errors(path, {errors.begin(), errors.end()});
  }
  if (!table.has("covariance_1"))
    throw InputError("measurement", path,
                     "must have a column named error, or columns covariance_1, covariance_2 ...");
  const auto size = static_cast<Index>(table.rows());
  Eigen::MatrixXd covariance(size, size);
  for (Index j = 0; j < size; ++j) {
    const auto column = table.column("covariance_" + std::to_string(j + 1));
    for (Index i = 0; i < size; ++i) covariance(i, j) = column[static_cast<std::size_t>(i)];
  }
  if (table.has("covariance_" + std::to_string(size + 1)) || !is_symmetric(covariance))
    throw InputError("measurement", path,
                     "must have one column covariance_1, covariance_2 ... for each row, which form "
                     "a symmetric matrix");
  return covariance;
}

/// Groups consecutive rows of a table into curves. A new curve begins where the depth changes; for
/// correlations over tilts and times, also where the light, the view or the distance changes, and
/// for intensities where the light changes.
class CurvesOfRows {
 public:
  /// detectors: one for each row of values at distances, else none.
  CurvesOfRows(const Table& table, Observable observable, CurveAxis axis,
               const mc::MovingSpec& medium, std::optional<mc::DistanceRequest> detectors)
      : observable_(observable),
        axis_(axis),
        medium_(medium),
        detectors_(std::move(detectors)),
        lights_(column_or(table, "light_angle", 0)),
        views_(column_or(table, "view_angle", 0)),
        at_(axis == CurveAxis::none
                ? observable == Observable::intensity ? views_ : lights_
                : column_or(table, axis_words[static_cast<std::size_t>(axis)], 0)),
        depths_(column_or(table, "depth", medium.depth.value_or(0))) {}

  std::vector<Curve> curves() const {
    std::vector<Curve> found;
    for (std::size_t row = 0; row < lights_.size(); ++row) {
      if (row == 0 || !continues_curve(row)) found.push_back(begun(row));
      add(found.back(), row);
    }
    for (Curve& curve : found)
      if (axis_ == CurveAxis::exposure)
        curve.delays = mc::exposure_delays(curve.times);
      else
        curve.delays = curve.times;
    return found;
  }

 private:
  bool continues_curve(std::size_t row) const {
    if (depths_[row] != depths_[row - 1]) return false;
    if (axis_ == CurveAxis::distance) return true;
    if (detectors_ && detectors_->detectors[row] != detectors_->detectors[row - 1]) return false;
    const bool same_light = lights_[row] == lights_[row - 1];
    if (axis_ != CurveAxis::none) return same_light && views_[row] == views_[row - 1];
    return observable_ != Observable::intensity || same_light;
  }

  Curve begun(std::size_t row) const {
    Curve curve{medium_, observable_, {}, {}};
    if (depths_[row] != 0) curve.scene.depth = depths_[row];
    curve.scene.light_angles.clear();
    curve.scene.view_angles = {views_[row]};
    if (!mc::is_flux(observable_)) curve.scene.light_angles = {lights_[row]};
    if (observable_ == Observable::intensity) curve.scene.view_angles.clear();
    if (axis_ == CurveAxis::tilt) curve.scene.covariance = "memory_effect";
    if (detectors_) {
      curve.scene.light_angles = {0};
      curve.distances = detectors_;
      curve.distances->detectors.clear();
    }
    return curve;
  }

  /// Returns the list of a curve to which each row appends its tilt, delay, exposure or angle.
  std::vector<double>& list(Curve& curve) const {
    if (axis_ == CurveAxis::tilt) return curve.scene.tilts;
    if (axis_ != CurveAxis::none) return curve.times;
    return observable_ == Observable::intensity ? curve.scene.view_angles
                                                : curve.scene.light_angles;
  }

  void add(Curve& curve, std::size_t row) const {
    if (axis_ != CurveAxis::distance) list(curve).push_back(at_[row]);
    if (detectors_) curve.distances->detectors.push_back(detectors_->detectors[row]);
    curve.entries.push_back(curve.entries.size());
    curve.abscissa.push_back(at_[row]);
  }

  Observable observable_;
  CurveAxis axis_;
  const mc::MovingSpec& medium_;
  std::optional<mc::DistanceRequest> detectors_;
  std::vector<double> lights_, views_, at_, depths_;
};

/// may_be_zero: whether a value at time 0 contains information.
void check_times(const std::string& path, CurveAxis axis, const std::vector<double>& times,
                 bool may_be_zero) {
  for (const double time : times)
    if (!(time > 0) && !(may_be_zero && time == 0))
      throw InputError("measurement", path,
                       axis_words[static_cast<std::size_t>(axis)] + " must be positive");
}

/// Throws InputError for flux fractions outside [0, 1] and correlations outside [-1, 1], unless
/// noise explains the excess. Such values may be meant as percentages.
void check_values(const mc::Measurement& measured, Observable observable, CurveAxis axis) {
  if (observable == Observable::intensity || axis == CurveAxis::distance) return;
  const bool share = observable > Observable::intensity;
  const double most_noise = share ? 0.15 : 0.5, least = share ? 0 : -1;
  for (Index i = 0; i < measured.values.size(); ++i) {
    const double noise = std::min(5 * std::sqrt(measured.covariance(i, i)), most_noise);
    const double value = measured.values[i];
    if (std::abs(value) > most_input) continue;  // such values are rejected by another check
    if (value > 1 + noise || value < least - noise)
      throw InputError("measurement = " + measured.name + ", " +
                           mc::observable_words[static_cast<std::size_t>(observable)],
                       value,
                       std::string("must be from ") + (share ? "0" : "-1") +
                           " to 1, within 5 errors; divide percentages by 100");
  }
}

/// Returns the table without rows at tilt or delay 0, if their correlation is always 1 and contains
/// no information.
Table without_trivial_rows(const std::string& path, const Table& table) {
  const char* const axis = table.has("delay") ? "delay" : "tilt";
  const bool correlations = table.has("field_correlation") ||
                            (table.has("intensity_correlation") && !is_at_distances(table));
  if (!correlations || !table.has(axis)) return table;
  const auto at = table.column(axis);
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::size_t number = 0, kept = 0;
  for (const std::string& name : table.names()) {
    const bool of_covariance = name.starts_with("covariance_");
    if (of_covariance && number < at.size() && at[number++] == 0) continue;
    names.push_back(of_covariance ? "covariance_" + std::to_string(++kept) : name);
    columns.emplace_back();
    for (std::size_t row = 0; row < at.size(); ++row)
      if (at[row] != 0) columns.back().push_back(table.column(name)[row]);
  }
  if (columns.front().empty())
    throw InputError("measurement", path,
                     std::string("must have rows with ") + axis + " other than 0");
  return {path, names, columns};
}

/// Returns the medium for light at distances: in space, with faces that reflect unpolarised light.
mc::MovingSpec in_space_of_distances(mc::MovingSpec medium) {
  medium.dimension = 3;
  if (medium.medium_index && !medium.polarisation) medium.polarisation = "unpolarised";
  return medium;
}

mc::Measurement measurement_of_values(const std::string& path, const Table& table,
                                      const Keys& fit_keys, const mc::MovingSpec& medium,
                                      const mc::DetectorValues& detectors) {
  const Observable observable = observable_of(path, table);
  const CurveAxis axis = axis_of(table, observable);
  check_columns(path, table, observable, axis);
  if (axis != CurveAxis::none) {
    const auto at = table.column(axis_words[static_cast<std::size_t>(axis)]);
    if (axis != CurveAxis::tilt)
      check_times(path, axis, {at.begin(), at.end()},
                  is_at_distances(table) && observable == Observable::intensity_correlation);
  }
  if (table.has("depth") && medium.depth)
    throw InputError("depth", *medium.depth, path + " has a column depth: leave the key out");
  mc::Measurement found;
  found.name = path;
  if (is_at_distances(table)) {
    const auto at = table.column("distance");
    found.curves =
        CurvesOfRows(table, observable, axis, in_space_of_distances(medium),
                     mc::make_detectors(fit_keys, detectors, "measurement = " + path + ", distance",
                                        {at.begin(), at.end()}))
            .curves();
  } else {
    found.curves = CurvesOfRows(table, observable, axis, medium, std::nullopt).curves();
  }
  const auto values = table.column(mc::observable_words[static_cast<std::size_t>(observable)]);
  found.values =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
  found.covariance = covariance_of(path, table);
  check_values(found, observable, axis);
  return found;
}

}  // namespace

mc::Measurement measurement_of_table(const std::string& path, const Keys& fit_keys,
                                     const mc::MovingSpec& medium,
                                     const mc::DetectorValues& detectors) {
  const Table table = read_key_table("measurement", path);
  if (table.has("field_re")) return measurement_of_fields(path, table, medium);
  if (table.has("speckle_intensity")) return measurement_of_intensities(path, table, medium);
  return measurement_of_values(path, without_trivial_rows(path, table), fit_keys, medium,
                               detectors);
}

}  // namespace flatspeckle::apps

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/fit/measurement_file.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

using Eigen::Index;
using mc::Curve;
using mc::Observable;

Observable observable_of(const std::string& path, const Table& table) {
  std::vector<Observable> found;
  for (std::size_t i = 0; i < mc::observable_words.size(); ++i)
    if (table.has(mc::observable_words[i])) found.push_back(static_cast<Observable>(i));
  if (found.size() != 1)
    throw InputError("measurement", path,
                     "must have one column among " + joined(mc::observable_words, " "));
  return found.front();
}

bool has_tilts(Observable observable) {
  return observable == Observable::field_correlation ||
         observable == Observable::intensity_correlation;
}

/// Throws for columns that nothing would read.
void check_columns(const std::string& path, const Table& table, Observable observable) {
  const std::string covariance = "covariance_";
  for (const std::string& name : table.names()) {
    const bool known = name == "error" || name == "light_angle" || name == "depth" ||
                       name.starts_with(covariance) ||
                       name == mc::observable_words[static_cast<std::size_t>(observable)] ||
                       (name == "view_angle" && observable <= Observable::intensity) ||
                       (name == "tilt" && has_tilts(observable));
    if (!known)
      throw InputError("measurement", path, "column " + name + ": nothing here has use for it");
  }
}

std::vector<double> column_or(const Table& table, const std::string& name, double value) {
  if (!table.has(name)) return std::vector<double>(table.rows(), value);
  const auto values = table.column(name);
  return {values.begin(), values.end()};
}

/// To rounding.
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
      throw InputError("measurement", path, "has errors and a covariance: leave one out");
    return independent_errors(path, {errors.begin(), errors.end()});
  }
  if (!table.has("covariance_1"))
    throw InputError("measurement", path,
                     "has no errors: must have a column error, or covariance_1, covariance_2 ...");
  const auto size = static_cast<Index>(table.rows());
  Eigen::MatrixXd covariance(size, size);
  for (Index j = 0; j < size; ++j) {
    const auto column = table.column("covariance_" + std::to_string(j + 1));
    for (Index i = 0; i < size; ++i) covariance(i, j) = column[static_cast<std::size_t>(i)];
  }
  if (table.has("covariance_" + std::to_string(size + 1)) || !is_symmetric(covariance))
    throw InputError("measurement", path,
                     "must have as many columns covariance_1 ... as rows, a symmetric matrix");
  return covariance;
}

/// Curves of rows that follow each other and have the same depth and light and, of tilts, view.
class CurvesOfRows {
 public:
  CurvesOfRows(const Table& table, Observable observable, const SceneSpec& medium)
      : observable_(observable),
        medium_(medium),
        lights_(column_or(table, "light_angle", 0)),
        views_(column_or(table, "view_angle", 0)),
        tilts_(column_or(table, "tilt", 0)),
        depths_(column_or(table, "depth", medium.depth.value_or(0))) {}

  std::vector<Curve> curves() const {
    std::vector<Curve> found;
    for (std::size_t row = 0; row < lights_.size(); ++row) {
      if (row == 0 || !joins(row)) found.push_back(begun(row));
      add(found.back(), row);
    }
    return found;
  }

 private:
  bool joins(std::size_t row) const {
    if (depths_[row] != depths_[row - 1]) return false;
    const bool same_light = lights_[row] == lights_[row - 1];
    if (has_tilts(observable_)) return same_light && views_[row] == views_[row - 1];
    return observable_ != Observable::intensity || same_light;
  }

  Curve begun(std::size_t row) const {
    Curve curve{medium_, observable_, {}, {}};
    if (depths_[row] != 0) curve.scene.depth = depths_[row];
    curve.scene.light_angles.clear();
    curve.scene.view_angles = {views_[row]};
    if (observable_ <= Observable::intensity) curve.scene.light_angles = {lights_[row]};
    if (observable_ == Observable::intensity) curve.scene.view_angles.clear();
    if (has_tilts(observable_)) curve.scene.covariance = "memory_effect";
    return curve;
  }

  void add(Curve& curve, std::size_t row) const {
    const double x = has_tilts(observable_)                 ? tilts_[row]
                     : observable_ == Observable::intensity ? views_[row]
                                                            : lights_[row];
    auto& axis = has_tilts(observable_)                 ? curve.scene.tilts
                 : observable_ == Observable::intensity ? curve.scene.view_angles
                                                        : curve.scene.light_angles;
    axis.push_back(x);
    curve.entries.push_back(curve.entries.size());
    curve.abscissa.push_back(x);
  }

  Observable observable_;
  const SceneSpec& medium_;
  std::vector<double> lights_, views_, tilts_, depths_;
};

}  // namespace

mc::Measurement measurement_of_table(const std::string& path, const SceneSpec& medium) {
  const Table table = read_csv(path);
  if (table.rows() == 0) throw InputError("measurement", path, "must have at least one row");
  const Observable observable = observable_of(path, table);
  check_columns(path, table, observable);
  if (has_tilts(observable)) table.column("tilt");
  if (table.has("depth") && medium.depth)
    throw InputError("depth", *medium.depth, path + " has depths of its own: leave the key out");
  mc::Measurement found;
  found.name = path;
  found.curves = CurvesOfRows(table, observable, medium).curves();
  const auto values = table.column(mc::observable_words[static_cast<std::size_t>(observable)]);
  found.values =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
  found.covariance = covariance_of(path, table);
  return found;
}

}  // namespace flatspeckle::apps

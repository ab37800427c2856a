#pragma once

#include <cmath>
#include <initializer_list>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "bench/stability/extreme_case.h"
#include "core/numbers/complex.h"

namespace flatspeckle::bench {

/// The rows of one room, written one after the other.
class ExtremeRows {
 public:
  explicit ExtremeRows(std::string room) : room_(std::move(room)) {}

  void add(std::string name, std::string invariant, std::function<Finding()> run) {
    rows_.push_back({room_, std::move(name), std::move(invariant), {}, std::move(run), false});
  }
  /// For one that takes more than about a second.
  void add_slow(std::string name, std::string invariant, std::function<Finding()> run) {
    add(std::move(name), std::move(invariant), std::move(run));
    rows_.back().slow = true;
  }
  /// What must be refused with a message that holds these words.
  void add_refused(std::string name, std::string must_say, const std::function<void()>& attempt) {
    add(std::move(name), "refused", [attempt] {
      attempt();
      return Finding{};
    });
    rows_.back().must_say = std::move(must_say);
  }

  std::vector<ExtremeCase> rows() && { return std::move(rows_); }

 private:
  std::string room_;
  std::vector<ExtremeCase> rows_;
};

std::vector<ExtremeCase> function_extremes();
std::vector<ExtremeCase> flatland_extremes();
std::vector<ExtremeCase> wave_extremes();
std::vector<ExtremeCase> wave_point_extremes();
std::vector<ExtremeCase> wave_cluster_extremes();
std::vector<ExtremeCase> mc_theory_extremes();
std::vector<ExtremeCase> mc_slab_extremes();
std::vector<ExtremeCase> mc_transport_extremes();
std::vector<ExtremeCase> mc_box_extremes();
std::vector<ExtremeCase> mc_varying_extremes();
std::vector<ExtremeCase> mc_imaging_extremes();
std::vector<ExtremeCase> index_extremes();
std::vector<ExtremeCase> ray_extremes();
std::vector<ExtremeCase> connection_extremes();
std::vector<ExtremeCase> flight_extremes();
std::vector<ExtremeCase> render_extremes();
std::vector<ExtremeCase> mesh_extremes();
std::vector<ExtremeCase> design_extremes();

/// A random figure: how many standard errors it is off, limit 4, beyond the relative accuracy of
/// what is expected. Infinite where the error is above `largest_error` of that, as then nothing was
/// tested.
Finding in_errors(Complex found, double error, Complex expected, double largest_error,
                  double accuracy = 0);

/// The largest figure; NaN where any is, which std::max would lose.
inline double larger(double a, double b) {
  return std::isnan(a) || a > b ? a : b;
}
inline double larger(std::initializer_list<double> figures) {
  return std::accumulate(figures.begin(), figures.end(), 0.0,
                         [](double a, double b) { return larger(a, b); });
}
/// The worse of two rows with one limit.
Finding worse(const Finding& a, const Finding& b);

/// |a - b| / |b|
double relative_difference(const std::vector<Complex>& a, const std::vector<Complex>& b);

/// As few characters as tell it, 1e-7 and 100: for the names of rows.
std::string short_number(double value);

}  // namespace flatspeckle::bench

#pragma once

#include <cmath>
#include <initializer_list>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "bench/stability/extreme_case.h"
#include "core/numbers/statistics.h"

namespace flatspeckle::bench {

/// Returns the shortest text of a number, such as 1e-7 or 100, for the names of rows.
std::string short_number(double value);

/// Collects the rows of the stability table. Each has a name, an invariant, and a check, which is
/// called with the given values and returns the deviation from the invariant.
class ExtremeRows {
 public:
  void begin_module(std::string name) { module_name_ = std::move(name); }

  template <class Check, class... Values>
  void add(std::string name, std::string invariant, const Check& check, const Values&... values) {
    rows_.push_back({module_name_,
                     std::move(name),
                     std::move(invariant),
                     {},
                     [=]() -> Finding { return check(values...); },
                     false});
  }
  /// Adds a row that takes more than about a second.
  template <class Check, class... Values>
  void add_slow(std::string name, std::string invariant, const Check& check,
                const Values&... values) {
    add_timed(true, std::move(name), std::move(invariant), check, values...);
  }
  /// Adds a row that is slow or not, as `is_slow` states.
  template <class Check, class... Values>
  void add_timed(bool is_slow, std::string name, std::string invariant, const Check& check,
                 const Values&... values) {
    add(std::move(name), std::move(invariant), check, values...);
    rows_.back().slow = is_slow;
  }
  /// Adds one row for each number. The number is part of the row's name and the first argument of
  /// the check.
  template <class Check, class... Values>
  void add_each(const std::string& before, std::initializer_list<double> numbers,
                const std::string& after, const std::string& invariant, const Check& check,
                const Values&... values) {
    for (const double number : numbers)
      add(before + short_number(number) + after, invariant, check, number, values...);
  }
  /// Adds a case that must be rejected with a message that contains `must_say`.
  template <class Attempt, class... Values>
  void add_refused(std::string name, std::string must_say, const Attempt& attempt,
                   const Values&... values) {
    add(std::move(name), "refused", [=] {
      attempt(values...);
      return Finding{};
    });
    rows_.back().must_say = std::move(must_say);
  }

  std::vector<ExtremeCase> rows() && { return std::move(rows_); }

 private:
  std::string module_name_;
  std::vector<ExtremeCase> rows_;
};

// Each of these functions adds the rows of one part of the program.
void function_extremes(ExtremeRows& rows);
void search_extremes(ExtremeRows& rows);
void flatland_extremes(ExtremeRows& rows);
void wave_extremes(ExtremeRows& rows);
void wave_point_extremes(ExtremeRows& rows);
void wave_space_extremes(ExtremeRows& rows);
void mc_theory_extremes(ExtremeRows& rows);
void mc_slab_extremes(ExtremeRows& rows);
void mc_transport_extremes(ExtremeRows& rows);
void mc_box_extremes(ExtremeRows& rows);
void mc_space_extremes(ExtremeRows& rows);
void mc_varying_extremes(ExtremeRows& rows);
void mc_imaging_extremes(ExtremeRows& rows);
void index_extremes(ExtremeRows& rows);
void ray_extremes(ExtremeRows& rows);
void connection_extremes(ExtremeRows& rows);
void flight_extremes(ExtremeRows& rows);
void render_extremes(ExtremeRows& rows);
void mesh_extremes(ExtremeRows& rows);
void design_extremes(ExtremeRows& rows);

// Checks shared by several rows.

/// Compares a random value with the expected one. The figure is the deviation that exceeds the
/// relative `accuracy` of the expected value, in standard errors; its limit is 4. The figure is
/// infinite if the relative standard error exceeds `largest_error`, because the comparison would
/// then be meaningless.
Finding in_errors(Complex found, double error, Complex expected, double largest_error,
                  double accuracy = 0);
/// Compares all values of two estimates, the first multiplied by `scale`, and returns the worst
/// result.
Finding in_errors(const Estimate& found, const Estimate& expected, double largest_error,
                  double scale = 1);
/// Compares all values of an estimate with known ones and returns the worst result.
Finding in_errors(const Estimate& found, const std::vector<Complex>& expected, double largest_error,
                  double accuracy = 0);

/// Compares the mean of sample(0) .. sample(count - 1) with the expected value, in standard errors
/// estimated from the samples.
template <class Sample>
Finding mean_in_errors(int count, const Sample& sample, double expected, double largest_error) {
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const double value = sample(i);
    sum += value / count;
    squares += value * value / count;
  }
  return in_errors(sum, std::sqrt((squares - sum * sum) / count), expected, largest_error);
}

/// Returns a result that passes if `happened`; otherwise its figure is 1.
inline Finding yes(bool happened) {
  return {happened ? 0.0 : 1.0, 0};
}

/// Returns the larger figure, or NaN if one is NaN, which std::max might ignore.
inline double larger(double a, double b) {
  return std::isnan(a) || a > b ? a : b;
}
inline double larger(std::initializer_list<double> figures) {
  return std::accumulate(figures.begin(), figures.end(), 0.0,
                         [](double a, double b) { return larger(a, b); });
}
/// Returns the largest figure_of(value) over all values.
template <class Values, class FigureOf>
Finding worst_of(const Values& values, double limit, const FigureOf& figure_of) {
  double worst = 0;
  for (const auto& value : values) worst = larger(worst, static_cast<double>(figure_of(value)));
  return {worst, limit};
}
template <class Value, class FigureOf>
Finding worst_of(std::initializer_list<Value> values, double limit, const FigureOf& figure_of) {
  return worst_of<std::initializer_list<Value>>(values, limit, figure_of);
}
/// Returns the worse of two results with the same limit.
Finding worse(const Finding& a, const Finding& b);

/// Returns |a - b| / |b|.
double relative_difference(const std::vector<Complex>& a, const std::vector<Complex>& b);

}  // namespace flatspeckle::bench

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

/// As few characters as tell it, 1e-7 and 100: for the names of rows.
std::string short_number(double value);

/// The rows of a table, written one after the other: a name, an invariant, and the check that finds
/// how far it is off in the case of some values.
class ExtremeRows {
 public:
  void begin_room(std::string name) { room_ = std::move(name); }

  template <class Check, class... Values>
  void add(std::string name, std::string invariant, const Check& check, const Values&... values) {
    rows_.push_back({room_,
                     std::move(name),
                     std::move(invariant),
                     {},
                     [=]() -> Finding { return check(values...); },
                     false});
  }
  /// For one that takes more than about a second.
  template <class Check, class... Values>
  void add_slow(std::string name, std::string invariant, const Check& check,
                const Values&... values) {
    add_timed(true, std::move(name), std::move(invariant), check, values...);
  }
  /// Slow in some cases.
  template <class Check, class... Values>
  void add_timed(bool is_slow, std::string name, std::string invariant, const Check& check,
                 const Values&... values) {
    add(std::move(name), std::move(invariant), check, values...);
    rows_.back().slow = is_slow;
  }
  /// A row for each of some numbers, which stands in its name and comes first of the values.
  template <class Check, class... Values>
  void add_each(const std::string& before, std::initializer_list<double> numbers,
                const std::string& after, const std::string& invariant, const Check& check,
                const Values&... values) {
    for (const double number : numbers)
      add(before + short_number(number) + after, invariant, check, number, values...);
  }
  /// What must be refused with a message that holds these words.
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
  std::string room_;
  std::vector<ExtremeCase> rows_;
};

// The rows of each part.
void function_extremes(ExtremeRows& rows);
void flatland_extremes(ExtremeRows& rows);
void wave_extremes(ExtremeRows& rows);
void wave_point_extremes(ExtremeRows& rows);
void mc_theory_extremes(ExtremeRows& rows);
void mc_slab_extremes(ExtremeRows& rows);
void mc_transport_extremes(ExtremeRows& rows);
void mc_box_extremes(ExtremeRows& rows);
void mc_varying_extremes(ExtremeRows& rows);
void mc_imaging_extremes(ExtremeRows& rows);
void index_extremes(ExtremeRows& rows);
void ray_extremes(ExtremeRows& rows);
void connection_extremes(ExtremeRows& rows);
void flight_extremes(ExtremeRows& rows);
void render_extremes(ExtremeRows& rows);
void mesh_extremes(ExtremeRows& rows);
void design_extremes(ExtremeRows& rows);

// Checks that rows share.

/// A random figure: how many standard errors it is off, limit 4, beyond the relative accuracy of
/// what is expected. Infinite where the error is above `largest_error` of that, as then nothing was
/// tested.
Finding in_errors(Complex found, double error, Complex expected, double largest_error,
                  double accuracy = 0);
/// All values of two estimates, the first times `scale`: the worst.
Finding in_errors(const Estimate& found, const Estimate& expected, double largest_error,
                  double scale = 1);
/// All values of an estimate against known ones: the worst.
Finding in_errors(const Estimate& found, const std::vector<Complex>& expected, double largest_error,
                  double accuracy = 0);

/// The mean of sample(0) .. sample(count - 1), in its own errors.
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

/// 1: what should have happened did not.
inline Finding yes(bool happened) {
  return {happened ? 0.0 : 1.0, 0};
}

/// The largest figure; NaN where any is, which std::max would lose.
inline double larger(double a, double b) {
  return std::isnan(a) || a > b ? a : b;
}
inline double larger(std::initializer_list<double> figures) {
  return std::accumulate(figures.begin(), figures.end(), 0.0,
                         [](double a, double b) { return larger(a, b); });
}
/// The largest figure_of(value) over all values.
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
/// The worse of two rows with one limit.
Finding worse(const Finding& a, const Finding& b);

/// |a - b| / |b|
double relative_difference(const std::vector<Complex>& a, const std::vector<Complex>& b);

}  // namespace flatspeckle::bench

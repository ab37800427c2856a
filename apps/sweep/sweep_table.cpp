#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/results/moments_table.h"
#include "apps/sweep/curve_result.h"

namespace flatspeckle::apps {

namespace {

class SweepTable {
 public:
  SweepTable(const CurveSweep& sweep, const CurveResults& results)
      : sweep_(sweep), results_(results), scene_(sweep.scene(results.points.front())) {}

  void print() const {
    note_few();
    if (results_.points.size() > most_rows) return;
    print_header();
    for (std::size_t i = 0; i < results_.points.size(); ++i) print_row(i);
  }

 private:
  bool both() const { return sweep_.method_words.size() > 1; }
  bool is_rough(const PointResult& result) const {
    return mc::few_steps(scene_.request.tilt_q, range_in_q(scene_, result));
  }

  void note_few() const {
    std::size_t few = 0, all = 0;
    for (const auto& points : results_.by_method) {
      all += points.size();
      few += static_cast<std::size_t>(
          std::ranges::count_if(points, [&](const PointResult& own) { return is_rough(own); }));
    }
    if (few > 0)
      std::fprintf(stderr,
                   "note: %zu of %zu ranges (marked *) are read off curves with fewer than four "
                   "tilts below them; their errors do not know what the curve does in between\n",
                   few, all);
  }

  void print_header() const {
    for (const SweepAxis& axis : sweep_.points().axes)
      if (axis.values.size() > 1) std::printf("%13s ", axis.key.c_str());
    for (const std::string& method : sweep_.method_words)
      std::printf(" %-24s", both() ? ("range q L, " + method).c_str() : "range q L at C_I = 1/2");
    std::puts(both() ? " deviation of C_E, RMS in standard errors" : "");
  }

  void print_row(std::size_t number) const {
    const SweepPoints& points = sweep_.points();
    for (std::size_t i = 0; i < points.axes.size(); ++i)
      if (points.axes[i].values.size() > 1)
        std::printf("%13s ", points.value(i, results_.points[number]).c_str());
    for (const auto& of_method : results_.by_method) {
      const PointResult& own = of_method[number];
      const std::string text =
          range_text({own.range, mc::Range::Censoring(own.range_censored)}, own.range_error) +
          (is_rough(own) ? " *" : "");
      std::printf(both() ? " %-24s" : " %s", text.c_str());
    }
    if (both()) std::printf(" %.2f", rms_deviation(number));
    std::puts("");
  }

  /// Over the tilts but 0, where both are 1.
  double rms_deviation(std::size_t number) const {
    double sum = 0, count = 0;
    const auto& curves = results_.by_method;
    for (double each : deviation(curves[0][number], curves[1][number])) {
      sum += each * each;
      count += each == 0 ? 0 : 1;
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
  }

  const CurveSweep& sweep_;
  const CurveResults& results_;
  Scene scene_;
};

}  // namespace

void print_ranges(const CurveSweep& sweep, const CurveResults& results) {
  SweepTable(sweep, results).print();
}

}  // namespace flatspeckle::apps

#include "apps/sweep/sweep_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/results/moments_table.h"

namespace flatspeckle::apps {

namespace {

class SweepTable {
 public:
  SweepTable(const SweepPlan& plan, const SweepResults& results)
      : plan_(plan),
        results_(results),
        points_(finished_points(plan, results)),
        scene_(plan.scene(points_.front())) {}

  void print() const {
    note_few();
    if (points_.size() > most_rows) return;
    print_header();
    for (std::size_t point : points_) print_row(point);
  }

 private:
  bool both() const { return plan_.method_words.size() > 1; }
  const PointResult& result(std::size_t method, std::size_t point) const {
    return *results_[plan_.run(method, point)];
  }
  bool is_rough(const PointResult& result) const {
    return mc::few_steps(scene_.request.tilt_q, range_in_q(scene_, result));
  }

  void note_few() const {
    std::size_t few = 0;
    for (std::size_t point : points_)
      for (std::size_t method = 0; method < plan_.method_words.size(); ++method)
        few += is_rough(result(method, point)) ? 1 : 0;
    if (few > 0)
      std::fprintf(stderr,
                   "note: %zu of %zu ranges (marked *) are read off curves with fewer than four "
                   "tilts below them; their errors do not know what the curve does in between\n",
                   few, points_.size() * plan_.method_words.size());
  }

  void print_header() const {
    for (const SweepAxis& axis : plan_.points.axes)
      if (axis.values.size() > 1) std::printf("%13s ", axis.key.c_str());
    for (const std::string& method : plan_.method_words)
      std::printf(" %-24s", both() ? ("range q L, " + method).c_str() : "range q L at C_I = 1/2");
    std::puts(both() ? " deviation of C_E, RMS in standard errors" : "");
  }

  void print_row(std::size_t point) const {
    for (std::size_t i = 0; i < plan_.points.axes.size(); ++i)
      if (plan_.points.axes[i].values.size() > 1)
        std::printf("%13s ", plan_.points.value(i, point).c_str());
    for (std::size_t method = 0; method < plan_.method_words.size(); ++method) {
      const PointResult& own = result(method, point);
      const std::string text =
          range_text({own.range, mc::Range::Censoring(own.range_censored)}, own.range_error) +
          (is_rough(own) ? " *" : "");
      std::printf(both() ? " %-24s" : " %s", text.c_str());
    }
    if (both()) std::printf(" %.2f", rms_deviation(point));
    std::puts("");
  }

  /// Over the tilts but 0, where both are 1.
  double rms_deviation(std::size_t point) const {
    double sum = 0, count = 0;
    for (double each : deviation(result(0, point), result(1, point))) {
      sum += each * each;
      count += each == 0 ? 0 : 1;
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
  }

  const SweepPlan& plan_;
  const SweepResults& results_;
  std::vector<std::size_t> points_;
  Scene scene_;
};

}  // namespace

void print_ranges(const SweepPlan& plan, const SweepResults& results) {
  SweepTable(plan, results).print();
}

}  // namespace flatspeckle::apps

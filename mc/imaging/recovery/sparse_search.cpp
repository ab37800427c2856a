#include "mc/imaging/recovery/sparse_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

#include "mc/imaging/recovery/ruler_fit.h"

namespace flatspeckle::mc {

namespace {

/// Sorted positions in steps, the first at 0, and what their pairs sum up to.
struct Ruler {
  std::vector<int> marks;
  double sum = 0;
};

/// A ruler and a further mark.
struct Longer {
  double sum;
  std::uint32_t parent;
  int mark;
};

class SparseSearch {
 public:
  /// scores: of a pair by its lag.
  SparseSearch(std::vector<double> scores, std::size_t points, int apart, std::size_t beam)
      : scores_(std::move(scores)),
        points_(points),
        apart_(apart),
        longest_(static_cast<int>(scores_.size()) - 1),
        beam_(beam) {}

  std::vector<Ruler> grown() {
    std::vector<Ruler> rulers{{{0}, 0}};
    while (rulers.front().marks.size() < points_) {
      longer_.clear();
      // an object of n points comes from n shorter ones
      const std::size_t kept = beam_ * (rulers.front().marks.size() + 1);
      for (std::uint32_t parent = 0; parent < rulers.size(); ++parent) {
        grow(rulers[parent], parent);
        if (longer_.size() > 4 * kept) keep(kept);
      }
      keep(kept);
      if (longer_.empty()) return {};
      rulers = best_of(rulers);
    }
    return rulers;
  }

 private:
  /// By each mark that keeps all distances distinct.
  void grow(const Ruler& ruler, std::uint32_t parent) {
    const int last = ruler.marks.back(), count = 2 * longest_ - last + 1;
    if (count <= 0) return;
    block(ruler);
    gains_.assign(static_cast<std::size_t>(count), ruler.sum);
    for (const int other : ruler.marks)  // of marks from last - longest_ on
      for (int k = 0; k < count; ++k)
        gains_[static_cast<std::size_t>(k)] +=
            scores_[static_cast<std::size_t>(std::abs(last - longest_ + k - other))];
    for (int k = 0; k < count; ++k)
      if (!blocked_[static_cast<std::size_t>(k)])
        longer_.push_back({gains_[static_cast<std::size_t>(k)], parent, last - longest_ + k});
  }

  /// Marks whose distances would not be distinct.
  void block(const Ruler& ruler) {
    const int first = ruler.marks.back() - longest_, count = longest_ - first + 1;
    blocked_.assign(static_cast<std::size_t>(count), 0);
    const auto from_to = [&](int from, int to) {
      for (int k = std::max(0, from - first); k <= std::min(count - 1, to - first); ++k)
        blocked_[static_cast<std::size_t>(k)] = 1;
    };
    const auto around = [&](int mark) { from_to(mark - apart_ + 1, mark + apart_ - 1); };
    for (const int mark : ruler.marks) {
      around(mark);
      for (const int a : ruler.marks)
        for (const int b : ruler.marks) {
          if (a >= b) continue;
          around(mark - (b - a));
          around(mark + (b - a));
        }
    }
    for (const int a : ruler.marks)
      for (const int b : ruler.marks)
        if (a < b) from_to((a + b - apart_ + 2) / 2, (a + b + apart_ - 1) / 2);
  }

  void keep(std::size_t count) {
    if (longer_.size() <= count) return;
    const auto before = [](const Longer& a, const Longer& b) {
      if (a.sum != b.sum) return a.sum > b.sum;
      return a.parent != b.parent ? a.parent < b.parent : a.mark < b.mark;
    };
    std::nth_element(longer_.begin(), longer_.begin() + static_cast<long>(count), longer_.end(),
                     before);
    longer_.resize(count);
  }

  static Ruler with(const Ruler& ruler, const Longer& by) {
    Ruler longer{ruler.marks, by.sum};
    longer.marks.insert(std::upper_bound(longer.marks.begin(), longer.marks.end(), by.mark),
                        by.mark);
    const int first = longer.marks.front();
    std::vector<int> mirrored;
    for (auto mark = longer.marks.rbegin(); mark != longer.marks.rend(); ++mark)
      mirrored.push_back(longer.marks.back() - *mark);
    for (int& each : longer.marks) each -= first;
    longer.marks = std::min(longer.marks, mirrored);
    return longer;
  }

  /// The largest sums, an object and its mirror image once.
  std::vector<Ruler> best_of(const std::vector<Ruler>& shorter) const {
    std::vector<Ruler> rulers;
    for (const Longer& each : longer_) rulers.push_back(with(shorter[each.parent], each));
    // the same object grown in another order differs by rounding
    std::sort(rulers.begin(), rulers.end(), [](const Ruler& a, const Ruler& b) {
      return a.marks != b.marks ? a.marks < b.marks : a.sum > b.sum;
    });
    const auto last = std::unique(rulers.begin(), rulers.end(), [](const Ruler& a, const Ruler& b) {
      return a.marks == b.marks;
    });
    rulers.erase(last, rulers.end());
    std::sort(rulers.begin(), rulers.end(), [](const Ruler& a, const Ruler& b) {
      return a.sum != b.sum ? a.sum > b.sum : a.marks < b.marks;
    });
    if (rulers.size() > beam_) rulers.resize(beam_);
    return rulers;
  }

  std::vector<double> scores_;
  std::size_t points_;
  int apart_, longest_;
  std::size_t beam_;
  std::vector<Longer> longer_;
  std::vector<double> gains_;  ///< by mark, from the last - longest_ on
  std::vector<char> blocked_;  ///< likewise
};

/// What a pair of mean brightness adds to the likelihood, but for a factor.
std::vector<double> scores_of(const PairPeaks& peaks, const std::vector<double>& expected) {
  std::vector<double> scores(peaks.height.size());
  const double full = expected.empty() || !(expected[0] > 0) ? 1 : expected[0];
  for (std::size_t lag = 0; lag < scores.size(); ++lag)
    scores[lag] = expected[0] > 0 ? expected[lag] / full * (peaks.height[lag] - expected[lag] / 2)
                                  : peaks.height[lag];
  return scores;
}

LineObject object_of(const RulerFit& fit, double step) {
  LineObject object{fit.marks, fit.brightness};
  const double first = *std::min_element(object.x.begin(), object.x.end()),
               mean = std::reduce(object.brightness.begin(), object.brightness.end()) /
                      static_cast<double>(object.x.size());
  for (double& x : object.x) x = (x - first) * step;
  if (mean > 0)
    for (double& b : object.brightness) b /= mean;
  return object;
}

}  // namespace

SparseFit sparse_search(const PairPeaks& peaks, const SparseTask& task) {
  const auto expected = expected_heights(peaks, task);
  const double resolution = task.resolution / peaks.step;
  const int apart = std::max(1, static_cast<int>(std::ceil(resolution)));
  std::vector<RulerFit> fits;
  for (const Ruler& ruler :
       SparseSearch(scores_of(peaks, expected), task.points, apart, task.beam).grown())
    fits.push_back(fitted_ruler(peaks, expected, {ruler.marks.begin(), ruler.marks.end()}));
  const auto likelier = [](const RulerFit& a, const RulerFit& b) { return a.gain > b.gain; };
  std::stable_sort(fits.begin(), fits.end(), likelier);
  constexpr std::size_t finalists = 20;
  if (fits.size() > finalists) fits.resize(finalists);
  for (RulerFit& fit : fits) fit = fitted_ruler(peaks, expected, std::move(fit.marks), resolution);
  std::stable_sort(fits.begin(), fits.end(), likelier);
  if (fits.empty()) return {};
  return {object_of(fits.front(), peaks.step), fits.front().explained};
}

}  // namespace flatspeckle::mc

#include "mc/recovery/sparse_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

namespace flatspeckle::mc {

namespace {

/// Sorted positions, the first at 0, and what their pairs sum up to.
struct Ruler {
  std::vector<int> marks;
  double sum = 0;
};

class Search {
 public:
  Search(std::span<const double> autocorrelation, const SparseTask& task)
      : autocorrelation_(autocorrelation),
        task_(task),
        apart_(std::max(1, static_cast<int>(std::ceil(task.resolution)))),
        longest_(static_cast<int>(autocorrelation.size()) - 1) {}

  std::vector<Ruler> grown() {
    std::vector<Ruler> rulers{{{0}, 0}};
    while (rulers.front().marks.size() < task_.points) {
      std::vector<Ruler> longer;
      for (const Ruler& ruler : rulers) grow(ruler, longer);
      if (longer.empty()) return {};
      rulers = best_of(std::move(longer));
    }
    return rulers;
  }

 private:
  bool near(int a, int b) const { return std::abs(a - b) < apart_; }

  /// By each mark that keeps all distances distinct.
  void grow(const Ruler& ruler, std::vector<Ruler>& longer) {
    taken_.assign(autocorrelation_.size(), false);
    for (std::size_t i = 0; i < ruler.marks.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) take(ruler.marks[i] - ruler.marks[j]);
    take(0);
    for (int mark = ruler.marks.back() - longest_; mark <= longest_; ++mark)
      if (const auto gain = gain_of(ruler, mark)) longer.push_back(with(ruler, mark, *gain));
  }
  void take(int distance) {
    const int from = std::max(0, distance - apart_ + 1),
              to = std::min(longest_, distance + apart_ - 1);
    std::fill(taken_.begin() + from, taken_.begin() + to + 1, true);
  }
  std::optional<double> gain_of(const Ruler& ruler, int mark) {
    distances_.clear();
    double gain = 0;
    for (const int other : ruler.marks) {
      const int distance = std::abs(mark - other);
      if (distance > longest_ || taken_[static_cast<std::size_t>(distance)]) return std::nullopt;
      for (const int before : distances_)
        if (near(before, distance)) return std::nullopt;
      distances_.push_back(distance);
      gain += autocorrelation_[static_cast<std::size_t>(distance)];
    }
    return gain;
  }
  static Ruler with(const Ruler& ruler, int mark, double gain) {
    Ruler longer = ruler;
    longer.marks.insert(std::upper_bound(longer.marks.begin(), longer.marks.end(), mark), mark);
    const int first = longer.marks.front();
    for (int& each : longer.marks) each -= first;
    longer.sum += gain;
    return longer;
  }

  /// The largest sums, an object and its mirror image once.
  std::vector<Ruler> best_of(std::vector<Ruler> rulers) const {
    for (Ruler& ruler : rulers) {
      std::vector<int> mirrored;
      for (auto mark = ruler.marks.rbegin(); mark != ruler.marks.rend(); ++mark)
        mirrored.push_back(ruler.marks.back() - *mark);
      ruler.marks = std::min(ruler.marks, mirrored);
    }
    std::sort(rulers.begin(), rulers.end(), [](const Ruler& a, const Ruler& b) {
      return a.sum != b.sum ? a.sum > b.sum : a.marks < b.marks;
    });
    const auto last = std::unique(rulers.begin(), rulers.end(), [](const Ruler& a, const Ruler& b) {
      return a.marks == b.marks;
    });
    rulers.erase(last, rulers.end());
    if (rulers.size() > task_.beam) rulers.resize(task_.beam);
    return rulers;
  }

  std::span<const double> autocorrelation_;
  SparseTask task_;
  int apart_, longest_;
  std::vector<bool> taken_;     ///< distances that a further pair may not have
  std::vector<int> distances_;  ///< of the mark at hand to the others
};

/// Brightness b with b_i b_j for the pairs' values, i < j, by alternating least squares.
std::vector<double> brightness_of(const std::vector<std::vector<double>>& pairs) {
  constexpr int sweeps = 50;
  const std::size_t n = pairs.size();
  double mean = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) mean += std::max(pairs[i][j], 0.0);
  std::vector<double> b(n, std::sqrt(2 * mean / static_cast<double>(n * (n - 1))));
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t i = 0; i < n; ++i) {
      double product = 0, square = 0;
      for (std::size_t j = 0; j < n; ++j)
        if (j != i) {
          product += pairs[i][j] * b[j];
          square += b[j] * b[j];
        }
      // two points share what their one pair has
      b[i] = n > 2 && square > 0 ? std::max(product / square, 0.0) : b[i];
    }
  return b;
}

SparseFit fitted(const Ruler& ruler, std::span<const double> autocorrelation) {
  const std::size_t n = ruler.marks.size();
  std::vector<std::vector<double>> pairs(n, std::vector<double>(n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (i != j)
        pairs[i][j] =
            autocorrelation[static_cast<std::size_t>(std::abs(ruler.marks[i] - ruler.marks[j]))];
  SparseFit fit{{{ruler.marks.begin(), ruler.marks.end()}, brightness_of(pairs)}};
  auto& b = fit.object.brightness;
  double product = 0, squares = 0, found = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      product += pairs[i][j] * b[i] * b[j];
      squares += b[i] * b[j] * b[i] * b[j];
      found += pairs[i][j] * pairs[i][j];
    }
  if (squares > 0 && found > 0) fit.explained = product / std::sqrt(squares * found);
  const double mean = std::reduce(b.begin(), b.end()) / static_cast<double>(n);
  if (mean > 0)
    for (double& value : b) value /= mean;
  return fit;
}

/// How much of the autocorrelation the pairs of a fit take away: larger is better.
double taken_away(const Ruler& ruler, const SparseFit& fit) {
  return ruler.sum * fit.explained;
}

}  // namespace

SparseFit sparse_search(std::span<const double> autocorrelation, const SparseTask& task) {
  SparseFit best;
  double most = 0;
  for (const Ruler& ruler : Search(autocorrelation, task).grown()) {
    const SparseFit fit = fitted(ruler, autocorrelation);
    if (const double away = taken_away(ruler, fit); away > most) {
      most = away;
      best = fit;
    }
  }
  return best;
}

}  // namespace flatspeckle::mc

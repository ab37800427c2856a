#include "mc/imaging/recovery/recovery.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "core/run/interrupt.h"
#include "mc/imaging/recovery/pair_brightness.h"

namespace flatspeckle::mc {

namespace {

/// Points at the positions `marks`, with their most likely brightness.
struct RulerFit {
  std::vector<double> marks, brightness;  ///< marks in units of PairPeaks::step
  double explained = 0;
  double gain = 0;  ///< twice the log likelihood, relative to that of an empty object
};

/// Returns the expected height of the peak of a pair of points with mean brightness, at each lag.
std::vector<double> expected_heights(const PairPeaks& peaks, const SparseTask& task) {
  const double equal = peaks.alone / static_cast<double>(task.points);
  std::vector<double> expected(peaks.height.size());
  for (std::size_t lag = 0; lag < expected.size(); ++lag)
    expected[lag] =
        equal * memory_correlation(static_cast<double>(lag) * peaks.step, task.memory_range);
  return expected;
}

/// Interpolates a line that is even about position 0, by cubics (Catmull and Rom).
double value_at(const std::vector<double>& line, double place) {
  const auto last = static_cast<long>(line.size()) - 1;
  const double lag = std::abs(place), below = std::floor(lag), t = lag - below;
  const auto at = [&](long offset) {
    return line[static_cast<std::size_t>(
        std::clamp(std::abs(static_cast<long>(below) + offset), 0L, last))];
  };
  const double a = at(-1), b = at(0), c = at(1), d = at(2);
  return b + t / 2 * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

/// Returns the peaks of all pairs of points at these marks. means: expected_heights().
PeakPairs pairs_of_marks(const PairPeaks& peaks, const std::vector<double>& means,
                         const std::vector<double>& marks) {
  PeakPairs pairs(marks.size());
  for (std::size_t i = 0; i < marks.size(); ++i)
    for (std::size_t j = 0; j < marks.size(); ++j)
      if (i != j) {
        pairs.height[i * marks.size() + j] = value_at(peaks.height, marks[i] - marks[j]);
        pairs.expected[i * marks.size() + j] = value_at(means, marks[i] - marks[j]);
      }
  return pairs;
}

/// Whether all marks, and all distances between two of them, differ by at least `apart`.
bool are_distinct(const std::vector<double>& marks, double apart) {
  std::vector<double> distances{0};
  for (std::size_t i = 0; i < marks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) distances.push_back(std::abs(marks[i] - marks[j]));
  std::sort(distances.begin(), distances.end());
  const auto nearer = [apart](double a, double b) { return b - a < apart; };
  return std::adjacent_find(distances.begin(), distances.end(), nearer) == distances.end();
}

/// Moves each mark by a quarter of a step, in each of several sweeps, if this increases the
/// likelihood. All distances stay distinct, because otherwise two pairs would share a peak.
void improve_marks(const PairPeaks& peaks, const std::vector<double>& expected, double apart,
                   double variance, const std::vector<double>& b, std::vector<double>& marks) {
  constexpr int sweeps = 4;
  constexpr double shift = 0.25;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t i = 0; i < marks.size(); ++i) {
      const double from = marks[i];
      double best = from, most = -1e300;
      for (const double mark : {from, from - shift, from + shift}) {
        marks[i] = mark;
        if (mark != from && !are_distinct(marks, apart)) continue;
        const double gain = gain_of(pairs_of_marks(peaks, expected, marks), b, i, variance);
        if (gain > most) {
          most = gain;
          best = mark;
        }
      }
      marks[i] = best;
    }
}

/// Fits the brightness of points at these marks. apart: if given, also optimises the marks; points,
/// and distances between points, then differ by at least this number of steps.
RulerFit fitted_ruler(const PairPeaks& peaks, const std::vector<double>& expected,
                      std::vector<double> marks, std::optional<double> apart = std::nullopt) {
  const double variance = std::max(peaks.noise * peaks.noise, 1e-12 * peaks.alone * peaks.alone);
  RulerFit fit;
  fit.brightness.assign(marks.size(), 1);
  improve_brightness(pairs_of_marks(peaks, expected, marks), variance, fit.brightness);
  if (apart) improve_marks(peaks, expected, *apart, variance, fit.brightness, marks);
  const PeakPairs pairs = pairs_of_marks(peaks, expected, marks);
  if (apart) improve_brightness(pairs, variance, fit.brightness);
  fit.gain = gain_of(pairs, fit.brightness, variance);
  fit.explained = pairs.explained(fit.brightness);
  fit.marks = std::move(marks);
  return fit;
}

/// A partial object in the search: sorted positions of its points (`marks`) in units of
/// PairPeaks::step, the first at 0, and the sum of the scores of its pairs.
struct Ruler {
  std::vector<int> marks;
  double sum = 0;
};

/// A ruler extended by one mark. parent: index of the ruler without this mark.
struct Longer {
  double sum;
  std::uint32_t parent;
  int mark;
};

class SparseSearch {
 public:
  /// scores: score of a pair at each lag. apart: least difference between two marks, and between
  /// two distances. beam: number of rulers that are kept, per mark.
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
      // n objects with one point less can grow to the same object of n points
      const std::size_t kept = beam_ * (rulers.front().marks.size() + 1);
      for (std::uint32_t parent = 0; parent < rulers.size(); ++parent) {
        stop_if_interrupted();
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
  /// Extends a ruler by one mark, in all ways that keep all distances distinct.
  void grow(const Ruler& ruler, std::uint32_t parent) {
    const int last = ruler.marks.back(), count = 2 * longest_ - last + 1;
    if (count <= 0) return;
    block(ruler);
    gains_.assign(static_cast<std::size_t>(count), ruler.sum);
    for (const int other : ruler.marks)  // index k is the new mark last - longest_ + k
      for (int k = 0; k < count; ++k)
        gains_[static_cast<std::size_t>(k)] +=
            scores_[static_cast<std::size_t>(std::abs(last - longest_ + k - other))];
    for (int k = 0; k < count; ++k)
      if (!blocked_[static_cast<std::size_t>(k)])
        longer_.push_back({gains_[static_cast<std::size_t>(k)], parent, last - longest_ + k});
  }

  /// Sets blocked_ for those positions of a new mark at which two distances would not be distinct.
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

  /// Returns the rulers of largest sum; an object and its mirror image count once.
  std::vector<Ruler> best_of(const std::vector<Ruler>& shorter) const {
    std::vector<Ruler> rulers;
    for (const Longer& each : longer_) rulers.push_back(with(shorter[each.parent], each));
    // Equal marks may be found in different orders, by which their sums differ in rounding.
    // Sorted by marks first, such duplicates are adjacent.
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
  std::vector<double> gains_;  ///< sum of scores for each new mark, from last - longest_ on
  std::vector<char> blocked_;  ///< whether each new mark is excluded, from last - longest_ on
};

/// Returns the contribution of a pair of points of mean brightness to the log likelihood at each
/// lag, up to a factor.
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

double memory_correlation(double distance, double memory_range) {
  constexpr double at_half = 1.49143;  // solution of (x / sinh x)^2 = 1/2
  const double x = memory_range > 0 ? at_half * distance / memory_range : 0;
  return x < 1e-4 ? 1 : std::pow(x / std::sinh(x), 2);
}

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

void add_keys(Keys& keys, DeconvolutionKeys& values) {
  keys.add("deconvolution", values.method, "Method of deconvolution of frames by the reference")
      .one_of({"wiener", "richardson_lucy"});
  keys.add("regularisation", values.task.regularisation,
           "deconvolution = wiener: noise power divided by the power of the reference's speckle")
      .positive();
  keys.add("iterations", values.task.iterations,
           "deconvolution = richardson_lucy: number of iterations")
      .from(1, 100000);
}

DeconvolutionTask deconvolution_task(const Keys& keys, const DeconvolutionKeys& values) {
  DeconvolutionTask task;
  if (keys.read(values.method) == "wiener") {
    task.regularisation = keys.read(values.task.regularisation);
  } else {
    task.method = DeconvolutionTask::Method::richardson_lucy;
    task.iterations = keys.read(values.task.iterations);
  }
  return task;
}

void add_average_key(Keys& keys, std::int64_t& average) {
  keys.add("average", average,
           "Number of frames of one object, each through another medium, whose autocorrelations "
           "are averaged before the search")
      .positive();
}

void add_camera_keys(Keys& keys, CameraNoise& noise) {
  keys.add("photons", noise.photons,
           "Mean number of photons of the light detected per pixel (default 0: no camera noise)")
      .not_negative();
  keys.add("read_noise", noise.read_noise,
           "Standard deviation of the camera's read noise, in photons")
      .not_negative();
}

void read_camera_keys(const Keys& keys, const CameraNoise& values, CameraNoise& noise) {
  noise.photons = keys.read(values.photons);
  if (noise.photons > 0) noise.read_noise = keys.read(values.read_noise);
}

Recovered recovered(std::span<const std::vector<double>> frames, const RecoveryTask& task) {
  Recovered found;
  found.statistics = frame_statistics(frames, task.lags, task.noise);
  if (task.points == 0 || found.statistics.grain == 0) return found;
  const double resolution = task.resolution_grains * found.statistics.peaks.width;
  SparseTask search{task.points, resolution};
  search.memory_range = task.memory_range;
  found.fit = sparse_search(found.statistics.peaks, search);
  return found;
}

}  // namespace flatspeckle::mc

#include "mc/imaging/retrieval/picture_points.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/run/interrupt.h"
#include "mc/imaging/recovery/pair_brightness.h"

namespace flatspeckle::mc {

namespace {

/// Offset of two points in whole pixels.
struct Lag {
  long y = 0, x = 0;

  friend Lag operator-(Lag a, Lag b) { return {a.y - b.y, a.x - b.x}; }
  friend auto operator<=>(const Lag&, const Lag&) = default;
  double length() const { return std::hypot(static_cast<double>(y), static_cast<double>(x)); }
};

/// Autocorrelation as a function of the lag.
class PairMap {
 public:
  PairMap(const std::vector<double>& values, std::size_t lags)
      : values_(values), reach_(static_cast<long>(lags) - 1) {}

  bool has(Lag lag) const { return std::max(std::abs(lag.y), std::abs(lag.x)) <= reach_; }
  double operator()(Lag lag) const {
    return values_[static_cast<std::size_t>((lag.y + reach_) * (2 * reach_ + 1) + lag.x + reach_)];
  }
  /// Returns the maxima at least this far from lag 0, the highest first.
  std::vector<Lag> maxima(double least) const {
    std::vector<Lag> found;
    for (long y = 1 - reach_; y < reach_; ++y)
      for (long x = 1 - reach_; x < reach_; ++x)
        if (const Lag lag{y, x}; lag.length() >= least && is_maximum(lag)) found.push_back(lag);
    std::ranges::stable_sort(found, std::ranges::greater{},
                             [this](Lag lag) { return (*this)(lag); });
    return found;
  }
  /// Returns the place of the maximum of a parabola about a lag along an axis, relative to the lag.
  double off(Lag lag, Lag step) const {
    const Lag before = lag - step, after = lag - Lag{-step.y, -step.x};
    if (!has(before) || !has(after)) return 0;
    const double rise = (*this)(after) - (*this)(before),
                 bend = 2 * (*this)(lag) - (*this)(after) - (*this)(before);
    return bend > 0 ? std::clamp(rise / (2 * bend), -0.5, 0.5) : 0;
  }

 private:
  bool is_maximum(Lag lag) const {
    for (long y = -1; y <= 1; ++y)
      for (long x = -1; x <= 1; ++x)
        if ((*this)(lag - Lag{y, x}) > (*this)(lag)) return false;
    return (*this)(lag) > 0;
  }

  const std::vector<double>& values_;
  long reach_;
};

/// A partial object: its points in the order of their lags, and the sum of the heights of its
/// pairs.
struct PartialPicture {
  std::vector<Lag> place;
  double sum = 0;
};

/// Whether a further point keeps all distances, and all differences of distances, at least
/// `apart`.
bool stays_distinct(const std::vector<Lag>& place, Lag added, double apart) {
  std::vector<Lag> before, after;
  for (std::size_t i = 0; i < place.size(); ++i) {
    after.push_back(added - place[i]);
    for (std::size_t j = 0; j < i; ++j) before.push_back(place[j] - place[i]);
  }
  const auto differ = [apart](Lag a, Lag b) {
    return (a - b).length() >= apart && (a - Lag{-b.y, -b.x}).length() >= apart;
  };
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after[i].length() < apart) return false;
    for (const Lag& other : before)
      if (!differ(after[i], other)) return false;
    for (std::size_t j = 0; j < i; ++j)
      if (!differ(after[i], after[j])) return false;
  }
  return true;
}

/// Returns the most likely objects, the best first.
std::vector<PartialPicture> grown_pictures(const PairMap& map, std::size_t points,
                                           double resolution) {
  constexpr std::size_t beam = 300;
  auto candidates = map.maxima(resolution);
  // Pairs contribute two maxima each; as many may be due to noise
  candidates.resize(std::min(candidates.size(), 2 * points * (points - 1)));
  if (candidates.empty()) return {};
  std::vector<PartialPicture> kept{{{Lag{}, candidates.front()}, map(candidates.front())}};
  std::ranges::sort(kept.front().place);
  while (kept.front().place.size() < points) {
    std::vector<PartialPicture> longer;
    for (const PartialPicture& one : kept) {
      stop_if_interrupted();
      for (const Lag& added : candidates) {
        const auto reaches = [&](Lag other) { return map.has(added - other); };
        if (!std::ranges::all_of(one.place, reaches) ||
            !stays_distinct(one.place, added, resolution))
          continue;
        PartialPicture more = one;
        for (const Lag& other : one.place) more.sum += map(added - other);
        more.place.insert(std::ranges::upper_bound(more.place, added), added);
        longer.push_back(std::move(more));
      }
    }
    const auto same = [](const PartialPicture& a, const PartialPicture& b) {
      return a.place == b.place;
    };
    std::ranges::sort(longer, {}, &PartialPicture::place);
    longer.erase(std::unique(longer.begin(), longer.end(), same), longer.end());
    std::ranges::stable_sort(longer, std::ranges::greater{}, &PartialPicture::sum);
    longer.resize(std::min(longer.size(), beam));
    if (longer.empty()) return {};
    kept = std::move(longer);
  }
  return kept;
}

PeakPairs pairs_of_places(const PairMap& map, const std::vector<Lag>& place) {
  const std::size_t n = place.size();
  const double equal = std::max(map({}), 0.0) / static_cast<double>(n);
  PeakPairs pairs(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (i != j) {
        pairs.height[i * n + j] = map(place[i] - place[j]);
        pairs.expected[i * n + j] = equal;
      }
  return pairs;
}

}  // namespace

PicturePoints picture_points(const PictureStatistics& statistics, std::size_t lags,
                             std::size_t points, double resolution) {
  const PairMap map(statistics.autocorrelation, lags);
  const double alone = map({}), noise = statistics.noise,
               variance = std::max(noise * noise, 1e-12 * alone * alone);
  PicturePoints best;
  double most = 0;
  std::vector<Lag> place;
  for (const PartialPicture& one : grown_pictures(map, points, resolution)) {
    const PeakPairs pairs = pairs_of_places(map, one.place);
    std::vector<double> brightness(points, 1);
    improve_brightness(pairs, variance, brightness);
    const double gain = gain_of(pairs, brightness, variance);
    if (!place.empty() && gain <= most) continue;
    most = gain;
    place = one.place;
    best.explained = pairs.explained(brightness);
    best.brightness = std::move(brightness);
  }
  if (place.empty()) return {};
  // Places whose differences fit the maxima of all pairs by least squares
  std::vector<std::tuple<double, double, double>> found;
  const auto n = static_cast<double>(points);
  for (std::size_t i = 0; i < points; ++i) {
    double x = 0, y = 0;
    for (std::size_t j = 0; j < points; ++j) {
      if (j == i) continue;
      const Lag lag = place[i] - place[j];
      x += (static_cast<double>(lag.x) + map.off(lag, {0, 1})) / n;
      y += (static_cast<double>(lag.y) + map.off(lag, {1, 0})) / n;
    }
    found.emplace_back(x, y, best.brightness[i]);
  }
  std::ranges::sort(found);
  const double mean = std::reduce(best.brightness.begin(), best.brightness.end()) / n;
  const auto [first_x, first_y, first] = found.front();
  best.brightness.clear();
  for (const auto& [x, y, b] : found) {
    best.x.push_back(x - first_x);
    best.y.push_back(y - first_y);
    best.brightness.push_back(mean > 0 ? b / mean : 1);
  }
  return best;
}

}  // namespace flatspeckle::mc

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numbers/fourier.h"
#include "core/numbers/symmetric.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/recovery/line_spectrum.h"
#include "mc/imaging/separation/separation.h"

namespace flatspeckle::mc {

namespace {

/// Computes the correlation of two patterns at the shifts -(lags - 1) to lags - 1.
class PatternCorrelations {
 public:
  PatternCorrelations(const Eigen::MatrixXd& patterns, std::size_t lags)
      : lags_(lags),
        spectra_(transform_size(static_cast<double>(patterns.rows()) + static_cast<double>(lags))) {
    for (Eigen::Index s = 0; s < patterns.cols(); ++s) {
      const std::vector<double> pattern(patterns.col(s).begin(), patterns.col(s).end());
      auto line = without_envelope(pattern, envelope_width(pattern.size(), lags));
      const double square = std::inner_product(line.begin(), line.end(), line.begin(), 0.0);
      if (square > 0)
        for (double& value : line) value /= std::sqrt(square);
      of_source_.push_back(spectra_.of(line));
    }
  }
  std::vector<double> operator()(std::size_t first, std::size_t second) const {
    auto product_of_both = of_source_[second];
    for (std::size_t m = 0; m < product_of_both.size(); ++m)
      product_of_both[m] = product(product_of_both[m], std::conj(of_source_[first][m]));
    return about_zero(spectra_.line(std::move(product_of_both)), lags_);
  }

 private:
  std::size_t lags_;
  LineSpectrum spectra_;
  std::vector<std::vector<Complex>> of_source_;
};

/// Returns the standard deviation of noise of mean 0 from its median magnitude, which a few peaks
/// hardly change.
double noise_of(std::vector<double> values) {
  constexpr double of_normal = 0.6745;
  for (double& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle / of_normal;
}

PatternShift peak_of(const std::vector<double>& correlation, std::size_t lags) {
  const auto at = std::max_element(correlation.begin(), correlation.end());
  const auto place = static_cast<double>(at - correlation.begin());
  PatternShift peak{.shift = place - static_cast<double>(lags - 1), .height = *at};
  if (at != correlation.begin() && at + 1 != correlation.end()) {
    const double bend = *(at - 1) - 2 * *at + *(at + 1);
    if (bend < 0) peak.shift += (*(at - 1) - *(at + 1)) / (2 * bend);
  }
  peak.noise = noise_of(correlation);
  return peak;
}

/// Sources connected by pairs with known shifts. Connected sources form a group (a tree), which has
/// common positions x.
class Tree {
 public:
  explicit Tree(std::size_t sources) : x_(sources), group_(sources) {
    std::iota(group_.begin(), group_.end(), std::size_t{0});
  }
  void join(const PatternShift& pair) {
    const std::size_t to = group_[pair.first], from = group_[pair.second];
    if (to == from) return;
    const double move = x_[pair.first] + pair.shift - x_[pair.second];
    for (std::size_t s = 0; s < x_.size(); ++s)
      if (group_[s] == from) {
        group_[s] = to;
        x_[s] += move;
      }
  }
  const std::vector<double>& x() const { return x_; }
  const std::vector<std::size_t>& group() const { return group_; }

 private:
  std::vector<double> x_;
  std::vector<std::size_t> group_;
};

/// Returns the positions by least squares over all pairs whose shifts agree with the positions in
/// `tree` within `within` pixels.
std::vector<double> settled(const Tree& tree, const std::vector<PatternShift>& shifts,
                            double within) {
  const auto sources = static_cast<Eigen::Index>(tree.x().size());
  Eigen::MatrixXd normal = 1e-9 * Eigen::MatrixXd::Identity(sources, sources);
  Eigen::VectorXd right = 1e-9 * Eigen::Map<const Eigen::VectorXd>(tree.x().data(), sources);
  for (const PatternShift& pair : shifts) {
    const auto a = static_cast<Eigen::Index>(pair.first),
               b = static_cast<Eigen::Index>(pair.second);
    if (std::abs(tree.x()[pair.second] - tree.x()[pair.first] - pair.shift) > within) continue;
    const double weight = pair.height * pair.height;
    normal(a, a) += weight;
    normal(b, b) += weight;
    normal(a, b) -= weight;
    normal(b, a) -= weight;
    right[a] -= weight * pair.shift;
    right[b] += weight * pair.shift;
  }
  const Eigen::VectorXd x = solve_symmetric(normal, right);
  return {x.begin(), x.end()};
}

/// Renumbers groups, the largest first.
std::vector<std::size_t> by_size(const std::vector<std::size_t>& group) {
  std::vector<std::size_t> members(group.size()), order(group.size()), rank(group.size());
  for (const std::size_t g : group) ++members[g];
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return members[a] > members[b]; });
  for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
  std::vector<std::size_t> renamed;
  for (const std::size_t g : group) renamed.push_back(rank[g]);
  return renamed;
}

}  // namespace

std::vector<PatternShift> pattern_shifts(const Eigen::MatrixXd& patterns, std::size_t lags) {
  const PatternCorrelations correlations(patterns, lags);
  const auto sources = static_cast<std::size_t>(patterns.cols());
  const double pairs = static_cast<double>(sources * (sources - 1) / 2),
               places = 2 * static_cast<double>(lags),
               times = std::sqrt(2 * std::log(100 * std::max(pairs, 1.0) * places));
  std::vector<PatternShift> shifts;
  for (std::size_t i = 0; i < sources; ++i)
    for (std::size_t j = i + 1; j < sources; ++j) {
      PatternShift pair = peak_of(correlations(i, j), lags);
      pair.first = i;
      pair.second = j;
      if (pair.height > times * pair.noise) shifts.push_back(pair);
    }
  return shifts;
}

SourcePlaces source_places(std::size_t sources, const std::vector<PatternShift>& shifts,
                           double within) {
  std::vector<PatternShift> ordered = shifts;
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.height > b.height; });
  Tree tree(sources);
  for (const PatternShift& pair : ordered) tree.join(pair);
  SourcePlaces places{settled(tree, shifts, within), by_size(tree.group())};
  std::vector<double> first(sources, 0);
  for (std::size_t s = sources; s-- > 0;) first[places.group[s]] = places.x[s];
  for (std::size_t s = 0; s < sources; ++s) places.x[s] -= first[places.group[s]];
  return places;
}

}  // namespace flatspeckle::mc

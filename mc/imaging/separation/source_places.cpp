#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numbers/fourier.h"
#include "core/numbers/symmetric.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/retrieval/picture_statistics.h"
#include "mc/imaging/separation/separation.h"

namespace flatspeckle::mc {

namespace {

/// Returns a pattern divided by its envelope, minus 1. rows: number of rows of its pixels.
std::vector<double> fluctuations(const std::vector<double>& pattern, std::size_t rows,
                                 std::size_t lags) {
  if (rows == 1) return without_envelope(pattern, envelope_width(pattern.size(), lags));
  const std::size_t columns = pattern.size() / rows;
  return picture_without_envelope(pattern, rows, columns,
                                  picture_envelope_width(std::min(rows, columns), lags));
}

/// Correlation of two patterns at shifts of less than `lags` pixels.
struct ShiftedProducts {
  long rows, columns;          ///< numbers of shifts along y and x; they are odd
  std::vector<double> values;  ///< [shift along y][shift along x]

  double at(long y, long x) const { return values[static_cast<std::size_t>(y * columns + x)]; }
};

/// Computes the correlation of two patterns at the shifts -(lags - 1) to lags - 1 along x and, for
/// pictures, along y.
class PatternCorrelations {
 public:
  PatternCorrelations(const Eigen::MatrixXd& patterns, std::size_t lags, std::size_t rows)
      : down_(rows == 1 ? 0 : static_cast<long>(lags) - 1),
        across_(static_cast<long>(lags) - 1),
        transform_(padded(rows, lags),
                   padded(static_cast<std::size_t>(patterns.rows()) / rows, lags)) {
    const std::size_t columns = static_cast<std::size_t>(patterns.rows()) / rows;
    std::vector<double> picture(transform_.rows() * transform_.columns());
    for (Eigen::Index s = 0; s < patterns.cols(); ++s) {
      const std::vector<double> pattern(patterns.col(s).begin(), patterns.col(s).end());
      const auto rest = fluctuations(pattern, rows, lags);
      const double square = std::inner_product(rest.begin(), rest.end(), rest.begin(), 0.0),
                   scale = square > 0 ? 1 / std::sqrt(square) : 1;
      std::ranges::fill(picture, 0);
      for (std::size_t p = 0; p < rest.size(); ++p)
        picture[p / columns * transform_.columns() + p % columns] = scale * rest[p];
      transform_.forward(picture.data(),
                         of_source_.emplace_back(transform_.spectrum_size()).data());
    }
  }
  ShiftedProducts operator()(std::size_t first, std::size_t second) const {
    auto spectrum = of_source_[second];
    for (std::size_t m = 0; m < spectrum.size(); ++m)
      spectrum[m] = product(spectrum[m], std::conj(of_source_[first][m]));
    const auto rows = static_cast<long>(transform_.rows()),
               columns = static_cast<long>(transform_.columns());
    std::vector<double> picture(transform_.rows() * transform_.columns());
    transform_.backward(spectrum.data(), picture.data());
    ShiftedProducts products{2 * down_ + 1, 2 * across_ + 1, {}};
    for (long y = -down_; y <= down_; ++y)
      for (long x = -across_; x <= across_; ++x)
        products.values.push_back(picture[static_cast<std::size_t>((y + rows) % rows * columns +
                                                                   (x + columns) % columns)] /
                                  static_cast<double>(picture.size()));
    return products;
  }

 private:
  static std::size_t padded(std::size_t pixels, std::size_t lags) {
    return pixels == 1 ? 1 : transform_size(static_cast<double>(pixels + lags));
  }

  long down_, across_;
  PlaneTransform transform_;
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

/// Returns the offset of the maximum of the parabola through three neighbouring values; 0 if they
/// have none.
double offset_of_peak(double before, double at, double after) {
  const double bend = before - 2 * at + after;
  return bend < 0 ? (before - after) / (2 * bend) : 0;
}

PatternShift peak_of(const ShiftedProducts& correlation) {
  const auto& [rows, columns, values] = correlation;
  const auto most = std::ranges::max_element(values);
  const long at = most - values.begin(), y = at / columns, x = at % columns;
  PatternShift peak{.shift = static_cast<double>(x - columns / 2),
                    .height = *most,
                    .shift_y = static_cast<double>(y - rows / 2)};
  if (x > 0 && x + 1 < columns)
    peak.shift += offset_of_peak(correlation.at(y, x - 1), *most, correlation.at(y, x + 1));
  if (y > 0 && y + 1 < rows)
    peak.shift_y += offset_of_peak(correlation.at(y - 1, x), *most, correlation.at(y + 1, x));
  peak.noise = noise_of(values);
  return peak;
}

/// Sources connected by pairs with known shifts. Connected sources form a group (a tree), which has
/// common positions x.
class Tree {
 public:
  explicit Tree(std::size_t sources)
      : places_(Eigen::MatrixX2d::Zero(static_cast<Eigen::Index>(sources), 2)), group_(sources) {
    std::iota(group_.begin(), group_.end(), std::size_t{0});
  }
  void join(const PatternShift& pair) {
    const std::size_t to = group_[pair.first], from = group_[pair.second];
    if (to == from) return;
    const Eigen::RowVector2d move = -difference(pair);
    for (std::size_t s = 0; s < group_.size(); ++s)
      if (group_[s] == from) {
        group_[s] = to;
        places_.row(static_cast<Eigen::Index>(s)) += move;
      }
  }
  /// Returns the displacement of the second source from the place at which the pair's shift puts
  /// it.
  Eigen::RowVector2d difference(const PatternShift& pair) const {
    return places_.row(static_cast<Eigen::Index>(pair.second)) -
           places_.row(static_cast<Eigen::Index>(pair.first)) -
           Eigen::RowVector2d(pair.shift, pair.shift_y);
  }
  const Eigen::MatrixX2d& places() const { return places_; }
  const std::vector<std::size_t>& group() const { return group_; }

 private:
  Eigen::MatrixX2d places_;  ///< x and y of each source
  std::vector<std::size_t> group_;
};

/// Returns the positions by least squares over all pairs whose shifts agree with the positions in
/// `tree` within `within` pixels.
Eigen::MatrixX2d settled(const Tree& tree, const std::vector<PatternShift>& shifts, double within) {
  const Eigen::Index sources = tree.places().rows();
  Eigen::MatrixXd normal = 1e-9 * Eigen::MatrixXd::Identity(sources, sources);
  Eigen::MatrixX2d right = 1e-9 * tree.places();
  for (const PatternShift& pair : shifts) {
    const auto a = static_cast<Eigen::Index>(pair.first),
               b = static_cast<Eigen::Index>(pair.second);
    if (tree.difference(pair).norm() > within) continue;
    const double weight = pair.height * pair.height;
    const Eigen::RowVector2d shift(pair.shift, pair.shift_y);
    normal(a, a) += weight;
    normal(b, b) += weight;
    normal(a, b) -= weight;
    normal(b, a) -= weight;
    right.row(a) -= weight * shift;
    right.row(b) += weight * shift;
  }
  Eigen::MatrixX2d places(sources, 2);
  for (Eigen::Index axis = 0; axis < 2; ++axis)
    places.col(axis) = solve_symmetric(normal, right.col(axis));
  return places;
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

std::vector<PatternShift> pattern_shifts(const Eigen::MatrixXd& patterns, std::size_t lags,
                                         std::size_t rows) {
  const PatternCorrelations correlations(patterns, lags, rows);
  const auto sources = static_cast<std::size_t>(patterns.cols());
  const double pairs = static_cast<double>(sources * (sources - 1) / 2),
               places = std::pow(2 * static_cast<double>(lags), rows == 1 ? 1 : 2),
               times = std::sqrt(2 * std::log(100 * std::max(pairs, 1.0) * places));
  std::vector<PatternShift> shifts;
  for (std::size_t i = 0; i < sources; ++i)
    for (std::size_t j = i + 1; j < sources; ++j) {
      PatternShift pair = peak_of(correlations(i, j));
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
  const Eigen::MatrixX2d found = settled(tree, shifts, within);
  const auto group = by_size(tree.group());
  Eigen::MatrixX2d first = Eigen::MatrixX2d::Zero(found.rows(), 2);
  for (Eigen::Index s = found.rows(); s-- > 0;)
    first.row(static_cast<Eigen::Index>(group[static_cast<std::size_t>(s)])) = found.row(s);
  SourcePlaces places{{}, {}, group};
  for (Eigen::Index s = 0; s < found.rows(); ++s) {
    const auto own = static_cast<Eigen::Index>(group[static_cast<std::size_t>(s)]);
    places.x.push_back(found(s, 0) - first(own, 0));
    places.y.push_back(found(s, 1) - first(own, 1));
  }
  return places;
}

}  // namespace flatspeckle::mc

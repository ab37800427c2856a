#include "mc/imaging/simulated/picture_score.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace flatspeckle::mc {

namespace {

/// Gaussian averages of pictures, without what lies beyond their edges.
class WindowMeans {
 public:
  WindowMeans(PictureSize size, double width) : size_(size) {
    const double sigma = width / std::sqrt(8 * std::numbers::ln2);
    reach_ = static_cast<long>(std::ceil(3 * sigma));
    for (long offset = -reach_; offset <= reach_; ++offset)
      weights_.push_back(std::exp(-std::pow(static_cast<double>(offset) / sigma, 2) / 2));
  }
  std::vector<double> operator()(const std::vector<double>& picture) const {
    const auto rows = static_cast<long>(size_.rows), columns = static_cast<long>(size_.columns);
    return along(along(picture, rows, columns, columns, 1), columns, rows, 1, columns);
  }

 private:
  /// Averages `lines` lines, which begin at multiples of `stride`, over pixels `step` apart.
  std::vector<double> along(const std::vector<double>& picture, long lines, long pixels,
                            long stride, long step) const {
    std::vector<double> mean(picture.size());
    for (long line = 0; line < lines; ++line)
      for (long p = 0; p < pixels; ++p) {
        double sum = 0, all = 0;
        for (long q = std::max(0L, p - reach_); q <= std::min(pixels - 1, p + reach_); ++q) {
          const double weight = weights_[static_cast<std::size_t>(q - p + reach_)];
          sum += weight * picture[static_cast<std::size_t>(line * stride + q * step)];
          all += weight;
        }
        mean[static_cast<std::size_t>(line * stride + p * step)] = sum / all;
      }
    return mean;
  }

  PictureSize size_;
  long reach_ = 0;
  std::vector<double> weights_;
};

std::vector<double> products(std::span<const double> a, std::span<const double> b) {
  std::vector<double> all(a.size());
  std::ranges::transform(a, b, all.begin(), std::multiplies<>());
  return all;
}

/// First and last row and column of a rectangle.
struct BrightRectangle {
  std::size_t top, bottom, left, right;
};

BrightRectangle rectangle_of(std::span<const double> truth, PictureSize size, double least) {
  BrightRectangle found{size.rows, 0, size.columns, 0};
  for (std::size_t y = 0; y < size.rows; ++y)
    for (std::size_t x = 0; x < size.columns; ++x) {
      if (truth[y * size.columns + x] < least) continue;
      found = {std::min(found.top, y), std::max(found.bottom, y), std::min(found.left, x),
               std::max(found.right, x)};
    }
  return found;
}

}  // namespace

double structural_similarity(std::span<const double> truth, std::span<const double> found,
                             PictureSize size, double width) {
  const double largest = *std::ranges::max_element(truth);
  const double square = std::inner_product(found.begin(), found.end(), found.begin(), 0.0);
  if (largest == 0 || square == 0) return 0;
  const double scale = std::inner_product(truth.begin(), truth.end(), found.begin(), 0.0) / square;
  std::vector<double> a(truth.begin(), truth.end()), b(found.begin(), found.end());
  for (double& value : a) value /= largest;
  for (double& value : b) value *= scale / largest;
  const WindowMeans mean(size, width);
  const auto of_a = mean(a), of_b = mean(b), aa = mean(products(a, a)), bb = mean(products(b, b)),
             ab = mean(products(a, b));
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  const auto [top, bottom, left, right] = rectangle_of(a, size, 0.01);
  double sum = 0;
  for (std::size_t y = top; y <= bottom; ++y)
    for (std::size_t x = left; x <= right; ++x) {
      const std::size_t p = y * size.columns + x;
      const double covariance = ab[p] - of_a[p] * of_b[p],
                   variances = aa[p] - of_a[p] * of_a[p] + bb[p] - of_b[p] * of_b[p];
      sum += (2 * of_a[p] * of_b[p] + c1) * (2 * covariance + c2) /
             ((of_a[p] * of_a[p] + of_b[p] * of_b[p] + c1) * (variances + c2));
    }
  return sum / static_cast<double>((bottom - top + 1) * (right - left + 1));
}

PictureScore picture_score(std::span<const double> truth, std::span<const double> found,
                           PictureSize size, double width) {
  PictureScore score{best_alignment(truth, found, size).applied(found, size)};
  score.similarity = structural_similarity(truth, score.aligned, size, width);
  return score;
}

}  // namespace flatspeckle::mc

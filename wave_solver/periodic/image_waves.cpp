#include "wave_solver/periodic/image_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "core/numbers/gauss.h"
#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

namespace {

// The field is the integral of plane waves over complex angles beta, measured from -x towards z:
// w = (-cos beta, sin beta).
struct PathNode {
  Complex beta, weight;
};

class ImageIntegral {
 public:
  ImageIntegral(double k, const Copies& copies, const Rectangle& region, double tolerance)
      : k_(k),
        copies_(copies),
        width_(region.width()),
        depth_(region.depth()),
        distance_(image_distance(copies, region)),
        tolerance_(tolerance),
        rule_(gauss_legendre(order)) {
    const double phase = k * copies.period + copies.phase;
    const double number = std::round(phase / (2 * std::numbers::pi));
    const double along =
        (2 * std::numbers::pi * number - copies.phase) / (k * copies.period);  // |k_x| / k
    grazing_ = std::sqrt(Complex((1 - along) * (1 + along)));
    const double nearest = 1.2 / std::sqrt(k * copies.period / 2);
    const double detour = std::min(nearest, 4 / (k * depth_));
    has_grazing_ = along > 0 && std::abs(grazing_) < 0.4 * detour;
    trace(has_grazing_ ? detour : 0);
  }

  const std::vector<PathNode>& nodes() const { return nodes_; }

  // Returns the residue of the channel if the path passes on the same side of both its poles,
  // beta = +-asin(grazing), although it must pass between them.
  std::optional<ImageWaves::Grazing> residue() const {
    if (!has_grazing_) return std::nullopt;
    const Complex cosine = std::sqrt(1.0 - grazing_ * grazing_);
    return ImageWaves::Grazing{
        {-cosine, -grazing_},
        2 / (k_ * copies_.period) * std::exp(Complex(0, -k_ * width_) * cosine),
        grazing_};
  }

 private:
  static constexpr int order = 16;

  // Along the path, factors exp(k depth |Im sin beta|) stay moderate up to angles from which the
  // waves decay towards the region faster than they grow with depth.
  void trace(double detour) {
    const double shift = std::min(0.5, 2.5 / (k_ * depth_));
    const double turn = std::max(std::atan(2 * depth_ / distance_), shift + 0.1);
    const double decay = distance_ * std::sin(turn) - depth_ * std::cos(turn);
    const double end = std::asinh(std::sinh(shift) + (6 - std::log(tolerance_)) / (k_ * decay));
    const std::vector<Complex> half{{shift, -shift}, {turn, -shift}, {turn, -end}};
    std::vector<Complex> path;
    for (std::size_t i = half.size(); i-- > 0;) path.push_back(-half[i]);
    if (detour > 0) {
      path.emplace_back(-detour, 0);
      path.emplace_back(0, -detour);
    } else {
      path.emplace_back(0, 0);
    }
    path.insert(path.end(), half.begin(), half.end());
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
      refine(path[i], path[i + 1], panel(path[i], path[i + 1]), 0);
  }

  std::array<PathNode, order> panel(Complex from, Complex to) const {
    std::array<PathNode, order> nodes;
    for (int i = 0; i < order; ++i) {
      const Complex beta = from + rule_.node[i] * (to - from);
      const Complex period =
          Complex(0, copies_.phase) + Complex(0, k_ * copies_.period) * std::cos(beta);
      const Complex first = Complex(0, (copies_.count + 1) * copies_.phase) +
                            Complex(0, k_ * distance_) * std::cos(beta);
      nodes[i] = {beta, rule_.weight[i] * (to - from) / std::numbers::pi * std::exp(first) /
                            (1.0 - std::exp(period))};
    }
    return nodes;
  }

  // Displacements, relative to the largest one towards the copies, at which the error is checked.
  static constexpr std::size_t checks = 6;
  std::array<Complex, checks> sums(std::span<const PathNode> nodes) const {
    std::array<Complex, checks> sums{};
    for (const PathNode& node : nodes) {
      const Complex x = Complex(0, k_) * std::cos(node.beta),
                    z = Complex(0, k_) * std::sin(node.beta);
      for (std::size_t i = 0; i < checks; ++i) {
        const double to_left = i < 3 ? 0 : width_,
                     along = (static_cast<double>(i % 3) - 1) * depth_;
        sums[i] += node.weight * std::exp(to_left * x + along * z);
      }
    }
    return sums;
  }

  double rounding(std::span<const PathNode> nodes) const {
    double size = 0;
    for (const PathNode& node : nodes)
      size += std::abs(node.weight) * std::exp(k_ * depth_ * std::abs(std::sin(node.beta).imag()));
    return 3e-15 * size;
  }

  void refine(Complex from, Complex to, const std::array<PathNode, order>& whole, int level) {
    constexpr int deepest = 40;
    const Complex middle = 0.5 * (from + to);
    const auto first = panel(from, middle), second = panel(middle, to);
    const auto once = sums(whole), one = sums(first), two = sums(second);
    double error = 0;
    for (std::size_t i = 0; i < checks; ++i)
      error = std::max(error, std::abs(once[i] - one[i] - two[i]));
    if (level == deepest || error < tolerance_ / 100 + rounding(whole)) {
      nodes_.insert(nodes_.end(), whole.begin(), whole.end());
      return;
    }
    refine(from, middle, first, level + 1);
    refine(middle, to, second, level + 1);
  }

  double k_;
  Copies copies_;
  double width_, depth_, distance_, tolerance_;
  QuadratureRule rule_;
  Complex grazing_;
  bool has_grazing_ = false;
  std::vector<PathNode> nodes_;
};

// Returns points on the edges of a rectangle, a quarter wavelength apart.
std::vector<Vec> edge_points(const Rectangle& region, double k) {
  const double spacing = std::numbers::pi / (2 * k);
  std::vector<Vec> points;
  const auto along = [&](Vec from, Vec to) {
    const int count = static_cast<int>(std::ceil(length(to - from) / spacing)) + 8;
    for (int i = 0; i < count; ++i)
      points.push_back(from + (static_cast<double>(i) / count) * (to - from));
  };
  const Vec low = region.low, high = region.high;
  along(high, {high.x, low.z});
  along({high.x, low.z}, low);
  along(low, {low.x, high.z});
  along({low.x, high.z}, high);
  return points;
}

}  // namespace

ImageWaves image_waves(double k, const Copies& copies, const Rectangle& region, double tolerance) {
  const ImageIntegral integral(k, copies, region, tolerance);
  const double middle = (region.low.z + region.high.z) / 2;
  ImageWaves found{{}, {}, {region.high.x, middle}, {region.low.x, middle}, integral.residue()};
  // Column j contains wave j, times the square root of its weight, at the edges of the region. The
  // waves b have the same values there, in another order.
  const auto points = edge_points(region, k);
  const auto& nodes = integral.nodes();
  const std::size_t rows = points.size(), columns = nodes.size();
  std::vector<Complex> waves(rows * columns);
  double largest = 0;
  for (std::size_t j = 0; j < columns; ++j) {
    const double size = std::sqrt(std::abs(nodes[j].weight));
    const Complex cosine = std::cos(nodes[j].beta), sine = std::sin(nodes[j].beta);
    for (std::size_t i = 0; i < rows; ++i) {
      const Vec r = points[i] - found.right;
      waves[i + rows * j] = size * std::exp(Complex(0, k) * (r.z * sine - r.x * cosine));
      largest = std::max(largest, std::abs(waves[i + rows * j]));
    }
  }
  const auto lapack_rows = static_cast<lapack_int>(rows);
  std::vector<lapack_int> pivots(columns);
  std::vector<Complex> reflectors(std::min(rows, columns));
  LAPACKE_zgeqp3(LAPACK_COL_MAJOR, lapack_rows, static_cast<lapack_int>(columns), waves.data(),
                 lapack_rows, pivots.data(), reflectors.data());
  const double negligible = tolerance / (largest * std::sqrt(static_cast<double>(columns)));
  std::size_t rank = 0;
  while (rank < std::min(rows, columns) && std::abs(waves[rank * (rows + 1)]) > negligible) ++rank;
  // Wave pivots[j] is the sum of the first `rank` ones times column j of `share`.
  triangular_solve(CblasLeft, CblasUpper, CblasNoTrans, rank, columns - rank, waves.data(), rows,
                   &waves[rank * rows], rows);
  std::vector<Complex> share(rank * columns), weighted(rank * columns);
  for (std::size_t j = 0; j < columns; ++j) {
    const PathNode& node = nodes[pivots[j] - 1];
    for (std::size_t i = 0; i < rank; ++i) {
      const double size = std::sqrt(std::abs(nodes[pivots[i] - 1].weight));
      share[i + rank * j] = size * (j < rank ? Complex(i == j) : waves[i + rows * j]);
      weighted[i + rank * j] = share[i + rank * j] * node.weight / std::abs(node.weight);
    }
    if (j < rank) found.w.emplace_back(-std::cos(node.beta), std::sin(node.beta));
  }
  found.coupling.resize(rank * rank);
  multiply(CblasNoTrans, CblasTrans, rank, rank, columns, 1, weighted.data(), rank, share.data(),
           rank, 0, found.coupling.data(), rank);
  return found;
}

}  // namespace flatspeckle::wave

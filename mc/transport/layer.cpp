#include "mc/transport/layer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flatspeckle::mc {

namespace {

/// tanh(sqrt(k)) / sqrt(k) by Lambert's continued fraction, to rounding within the unit circle (at
/// its edge 4e-12).
Matrix tanh_ratio(const Matrix& k) {
  const Matrix one = Matrix::Identity(k.rows(), k.cols()), k2 = product(k, k), k3 = product(k2, k);
  return product(inverse(135135 * one + 62370 * k + 3150 * k2 + 28 * k3),
                 135135 * one + 17325 * k + 378 * k2 + k3);
}

/// (1 + a)^-1 a
Matrix share(const Matrix& a) {
  return product(inverse(Matrix::Identity(a.rows(), a.cols()) + a), a);
}

PairWaves joined(const PairWaves& a, const PairWaves& b) {
  const auto stacked = [](const auto& upper, const auto& lower) {
    Rows both(upper.rows() + lower.rows(), upper.cols());
    both << upper, lower;
    return both;
  };
  return {stacked(a.top, b.top), stacked(a.bottom, b.bottom), stacked(a.down, b.down),
          stacked(a.up, b.up)};
}

/// Radiance of both ways, in rows.
struct BothWays {
  Rows down, up;

  BothWays& operator+=(const BothWays& other) {
    down += other.down;
    up += other.up;
    return *this;
  }
};

BothWays scaled(const Eigen::VectorXcd& factor, const BothWays& rows) {
  return {factor.asDiagonal() * rows.down, factor.asDiagonal() * rows.up};
}

/// A layer by what leaves it, the same from above and below: `reflected` and `lost` = 1 - transmitted
/// radiance (of a thin layer small, so that albedo 1 balances to rounding of it), and what leaves
/// of the lights and, turned round, of the views.
class Layer {
 public:
  Layer(const TransportOperator& medium, double depth, const PairWaves& lights,
        const PairWaves& views);
  /// Puts another one on top.
  void double_depth();
  LayerResponse response() const {
    return {leaves_.up.topRows(lights_), leaves_.down.topRows(lights_), collected_};
  }

 private:
  void start_radiance(const TransportOperator& medium);
  void start_pairs(const TransportOperator& medium);
  Eigen::MatrixXcd collected_in_series(const std::vector<BothWays>& series) const;
  Eigen::MatrixXcd contracted(const Rows& views, const Rows& lights) const;
  Rows of_lights(const Rows& rows) const { return rows.topRows(lights_); }
  Rows of_views(const Rows& rows) const { return rows.bottomRows(rows.rows() - lights_); }

  double depth_;
  Eigen::Index lights_, even_;
  PairWaves waves_;
  Matrix reflected_, lost_, transmitted_;
  BothWays leaves_;
  Eigen::MatrixXcd collected_;
};

Layer::Layer(const TransportOperator& medium, double depth, const PairWaves& lights,
             const PairWaves& views)
    : depth_(depth),
      lights_(lights.top.size()),
      even_(medium.even),
      waves_(joined(lights, views)) {
  start_radiance(medium);
  start_pairs(medium);
}

/// Mirrors in its middle make two problems of a layer: D = m S and S = n D at the top for equal and
/// for opposite radiance from both sides, m = (d/2) y tanh_ratio(x y d^2/4).
void Layer::start_radiance(const TransportOperator& medium) {
  const double half = depth_ / 2;
  const auto loss = [&](const Matrix& inner, const Matrix& outer) {
    return share(half * product(outer, tanh_ratio(half * half * product(inner, outer))));
  };
  const Matrix equal = loss(medium.x, medium.y), opposite = loss(medium.y, medium.x);
  reflected_ = opposite - equal;
  lost_ = opposite + equal;
  transmitted_ = Matrix::Identity(lost_.rows(), lost_.cols()) - lost_;
}

/// Power series in z of what lights feed into a layer that no radiance enters at the top; then
/// radiance enters from below so that none enters there in sum.
void Layer::start_pairs(const TransportOperator& medium) {
  constexpr int terms = 30;
  const Matrix a = (medium.x + medium.y) / 2, b = (medium.x - medium.y) / 2;
  const Eigen::VectorXcd rate = waves_.top - waves_.bottom,
                         start = (depth_ * waves_.bottom.array()).exp();
  BothWays fed = scaled(start, {waves_.down, -waves_.up});
  std::vector<BothWays> series;
  BothWays sum{Rows::Zero(fed.down.rows(), fed.down.cols()),
               Rows::Zero(fed.up.rows(), fed.up.cols())};
  BothWays term = sum;
  for (int j = 0; j < terms; ++j) {
    BothWays next{product(term.up, b) - product(term.down, a),
                  product(term.up, a) - product(term.down, b)};
    next += fed;
    const Eigen::VectorXcd step = Eigen::VectorXcd::Constant(rate.size(), depth_ / (j + 1));
    term = scaled(step, next);
    fed = scaled(rate.array() * step.array(), fed);
    sum += term;
    series.push_back({of_lights(term.down), of_lights(term.up)});
  }
  leaves_ = {sum.down - product(sum.up, reflected_), -product(sum.up, transmitted_)};
  collected_ =
      collected_in_series(series) - contracted(of_views(leaves_.down), of_lights(sum.up));
}

/// What views collect of the radiance sum_j series[j] (z / depth)^(j+1).
Eigen::MatrixXcd Layer::collected_in_series(const std::vector<BothWays>& series) const {
  const Rows from_up = of_views(waves_.down), from_down = of_views(waves_.up);
  const Eigen::Index views = from_up.rows();
  const Eigen::VectorXcd rate = depth_ * (waves_.top - waves_.bottom).tail(views),
                         start = (depth_ * waves_.bottom.array()).exp().tail(views);
  Eigen::MatrixXcd collected = Eigen::MatrixXcd::Zero(views, lights_);
  for (std::size_t j = 0; j < series.size(); ++j) {
    // depth int_0^1 exp(rate u) u^(j+1) du
    Eigen::VectorXcd moment = Eigen::VectorXcd::Zero(views),
                     power = Eigen::VectorXcd::Constant(views, depth_);
    for (std::size_t i = 0; i < series.size(); ++i) {
      moment += power / static_cast<double>(i + j + 2);
      power = power.array() * rate.array() / static_cast<double>(i + 1);
    }
    collected += (start.array() * moment.array()).matrix().asDiagonal() *
                 (contracted(from_down, series[j].down) + contracted(from_up, series[j].up));
  }
  return collected;
}

/// [view][light]; of the signs that rows have, one is turned back.
Eigen::MatrixXcd Layer::contracted(const Rows& views, const Rows& lights) const {
  const Eigen::Index odd = views.cols() - even_;
  return views.leftCols(even_) * lights.leftCols(even_).transpose() -
         views.rightCols(odd) * lights.rightCols(odd).transpose();
}

/// Of radiance between the halves: down = r lights' + reflected up, up likewise; (1 - r^2)^-1 sums
/// it.
void Layer::double_depth() {
  const Eigen::Index n = lost_.rows();
  const Matrix sums = inverse(Matrix::Identity(n, n) - product(reflected_, reflected_)),
               down = product(sums, transmitted_), up = product(reflected_, down);
  const Eigen::VectorXcd upper = (depth_ * waves_.bottom.array()).exp(),
                         lower = (depth_ * waves_.top.array()).exp();
  const BothWays above = scaled(upper, leaves_), below = scaled(lower, leaves_);
  const Rows meets_down = above.down + product(below.up, reflected_),
             meets_up = below.up + product(above.down, reflected_);
  const Eigen::Index views = waves_.top.size() - lights_;
  const auto factor = [&](const Eigen::VectorXcd& all) {
    return all.tail(views) * all.head(lights_).transpose();
  };
  collected_ = collected_.cwiseProduct(factor(upper) + factor(lower)) +
               contracted(of_views(above.down), product(of_lights(meets_up), sums)) +
               contracted(of_views(below.up), product(of_lights(meets_down), sums));
  leaves_ = {below.down + product(meets_down, down), above.up + product(meets_up, down)};
  lost_ = 2 * lost_ - product(lost_, lost_) - product(transmitted_, product(reflected_, up));
  reflected_ += product(transmitted_, up);
  transmitted_ = Matrix::Identity(n, n) - lost_;
  depth_ *= 2;
}

double fastest_rate(const TransportOperator& medium, const PairWaves& waves) {
  double rate = medium.fastest;
  for (Eigen::Index i = 0; i < waves.top.size(); ++i)
    rate = std::max(rate, std::abs(waves.top[i] - waves.bottom[i]));
  return rate;
}

}  // namespace

LayerResponse layer_response(const TransportOperator& medium, double depth, const PairWaves& lights,
                             const PairWaves& views) {
  const double rate = std::max(fastest_rate(medium, lights), fastest_rate(medium, views));
  const int doublings = std::max(0, static_cast<int>(std::ceil(std::log2(depth * rate / 2))));
  Layer layer(medium, std::ldexp(depth, -doublings), lights, views);
  for (int i = 0; i < doublings; ++i) layer.double_depth();
  return layer.response();
}

}  // namespace flatspeckle::mc

#include "mc/transport/layer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/run/interrupt.h"

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

std::vector<Complex> joined(std::vector<Complex> list, const std::vector<Complex>& rest) {
  list.insert(list.end(), rest.begin(), rest.end());
  return list;
}

Rows joined(const Rows& upper, const Rows& lower) {
  Rows both(upper.rows() + lower.rows(), upper.cols());
  both.topRows(upper.rows()) = upper;
  both.bottomRows(lower.rows()) = lower;
  return both;
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

BothWays scaled(const std::vector<Complex>& factor, const BothWays& rows) {
  return {flatspeckle::mc::scaled(factor, rows.down), flatspeckle::mc::scaled(factor, rows.up)};
}

std::vector<Complex> times(double factor, std::vector<Complex> list) {
  for (Complex& value : list) value *= factor;
  return list;
}

/// exp(depth rate) of each.
std::vector<Complex> damping(std::vector<Complex> rates, double depth) {
  for (Complex& rate : rates) rate = std::exp(depth * rate);
  return rates;
}

/// depth int_0^1 exp(rate u) u^power du by its series.
Complex moment(Complex rate, std::size_t power, double depth) {
  constexpr int terms = 30;
  Complex sum = 0, term = depth;
  for (int i = 0; i < terms; ++i) {
    sum += term / static_cast<double>(static_cast<std::size_t>(i) + power + 1);
    term *= rate / static_cast<double>(i + 1);
  }
  return sum;
}

/// A layer by what leaves it, the same from above and below: `reflected` and `lost` = 1 -
/// transmitted radiance (of a thin layer small, so that albedo 1 balances to rounding of it), and
/// what leaves of the lights and, turned round, of the views.
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
  Rows collected_in_series(const std::vector<BothWays>& series) const;
  Rows contracted(const Rows& views, Rows lights) const;
  std::vector<Complex> rates() const;
  Rows of_lights(const Rows& rows) const { return rows.topRows(lights_); }
  Rows of_views(const Rows& rows) const { return rows.bottomRows(rows.rows() - lights_); }

  double depth_;
  Eigen::Index lights_, even_;
  PairWaves waves_;
  Matrix reflected_, lost_, transmitted_;
  BothWays leaves_;
  Rows collected_;
};

Layer::Layer(const TransportOperator& medium, double depth, const PairWaves& lights,
             const PairWaves& views)
    : depth_(depth),
      lights_(lights.top.size()),
      even_(medium.even),
      waves_{joined(lights.top, views.top), joined(lights.bottom, views.bottom),
             joined(lights.down, views.down), joined(lights.up, views.up)} {
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
  BothWays fed = scaled(damping(waves_.bottom, depth_), {waves_.down, -waves_.up});
  std::vector<BothWays> series;
  BothWays sum{0 * fed.down, 0 * fed.up}, term = sum;
  for (int j = 0; j < terms; ++j) {
    const double step = depth_ / (j + 1);
    term = {step * (product(term.up, b) - product(term.down, a) + fed.down),
            step * (product(term.up, a) - product(term.down, b) + fed.up)};
    fed = scaled(times(step, rates()), fed);
    sum += term;
    series.push_back({of_lights(term.down), of_lights(term.up)});
  }
  leaves_ = {sum.down - product(sum.up, reflected_), -product(sum.up, transmitted_)};
  collected_ = collected_in_series(series) - contracted(of_views(leaves_.down), of_lights(sum.up));
}

/// What views collect of the radiance sum_j series[j] (z / depth)^(j+1).
Rows Layer::collected_in_series(const std::vector<BothWays>& series) const {
  const Rows from_up = of_views(waves_.down), from_down = of_views(waves_.up);
  const auto rate = times(depth_, rates()), start = damping(waves_.bottom, depth_);
  Rows collected = Rows::Zero(from_up.rows(), lights_);
  for (std::size_t j = 0; j < series.size(); ++j) {
    std::vector<Complex> factor;
    for (auto v = static_cast<std::size_t>(lights_); v < rate.size(); ++v)
      factor.push_back(start[v] * moment(rate[v], j + 1, depth_));
    collected += flatspeckle::mc::scaled(
        factor, contracted(from_down, series[j].down) + contracted(from_up, series[j].up));
  }
  return collected;
}

/// [view][light]; of the signs that rows have, one is turned back.
Rows Layer::contracted(const Rows& views, Rows lights) const {
  for (Eigen::Index j = even_; j < lights.cols(); ++j)
    for (Eigen::Index i = 0; i < lights.rows(); ++i) lights(i, j) = -lights(i, j);
  return product_transposed(views, lights);
}

/// Of waves along z from the bottom to the top.
std::vector<Complex> Layer::rates() const {
  std::vector<Complex> list;
  for (std::size_t i = 0; i < waves_.top.size(); ++i)
    list.push_back(waves_.top[i] - waves_.bottom[i]);
  return list;
}

/// Of radiance between the halves: down = r lights' + reflected up, up likewise; (1 - r^2)^-1 sums
/// it.
void Layer::double_depth() {
  const Eigen::Index n = lost_.rows();
  const Matrix sums = inverse(Matrix::Identity(n, n) - product(reflected_, reflected_)),
               down = product(sums, transmitted_), up = product(reflected_, down);
  const auto upper = damping(waves_.bottom, depth_), lower = damping(waves_.top, depth_);
  const BothWays above = scaled(upper, leaves_), below = scaled(lower, leaves_);
  const Rows meets_down = above.down + product(below.up, reflected_),
             meets_up = below.up + product(above.down, reflected_);
  const auto lights = static_cast<std::size_t>(lights_);
  for (std::size_t l = 0; l < lights; ++l)
    for (std::size_t v = lights; v < upper.size(); ++v)
      collected_(static_cast<Eigen::Index>(v - lights), static_cast<Eigen::Index>(l)) *=
          upper[v] * upper[l] + lower[v] * lower[l];
  collected_ += contracted(of_views(above.down), product(of_lights(meets_up), sums)) +
                contracted(of_views(below.up), product(of_lights(meets_down), sums));
  leaves_ = {below.down + product(meets_down, down), above.up + product(meets_up, down)};
  lost_ = 2 * lost_ - product(lost_, lost_) - product(transmitted_, product(reflected_, up));
  reflected_ += product(transmitted_, up);
  transmitted_ = Matrix::Identity(n, n) - lost_;
  depth_ *= 2;
}

double fastest_rate(const TransportOperator& medium, const PairWaves& waves) {
  double rate = medium.fastest;
  for (std::size_t i = 0; i < waves.top.size(); ++i)
    rate = std::max(rate, std::abs(waves.top[i] - waves.bottom[i]));
  return rate;
}

}  // namespace

LayerResponse layer_response(const TransportOperator& medium, double depth, const PairWaves& lights,
                             const PairWaves& views) {
  const double rate = std::max(fastest_rate(medium, lights), fastest_rate(medium, views));
  const int doublings = std::max(0, static_cast<int>(std::ceil(std::log2(depth * rate / 2))));
  Layer layer(medium, std::ldexp(depth, -doublings), lights, views);
  for (int i = 0; i < doublings; ++i) {
    stop_if_interrupted();
    layer.double_depth();
  }
  return layer.response();
}

}  // namespace flatspeckle::mc

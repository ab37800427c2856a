#include "mc/transport/layer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/run/interrupt.h"

namespace flatspeckle::mc {

namespace {

/// tanh(sqrt(k)) / sqrt(k) by Lambert's continued fraction, to rounding within the unit circle (at
/// its edge 4e-12).
template <typename M>
M tanh_ratio(const M& k) {
  const M one = identity_like(k), k2 = product(k, k), k3 = product(k2, k);
  return product(inverse(M(135135.0 * one + 62370.0 * k + 3150.0 * k2 + 28.0 * k3)),
                 M(135135.0 * one + 17325.0 * k + 378.0 * k2 + k3));
}

/// (1 + a)^-1 a
template <typename M>
M share(const M& a) {
  return product(inverse(M(identity_like(a) + a)), a);
}

template <typename T>
std::vector<T> joined(std::vector<T> list, const std::vector<T>& rest) {
  list.insert(list.end(), rest.begin(), rest.end());
  return list;
}

Rows joined(const Rows& upper, const Rows& lower) {
  Rows both(upper.rows() + lower.rows(), upper.cols());
  both.topRows(upper.rows()) = upper;
  both.bottomRows(lower.rows()) = lower;
  return both;
}

Dual<Rows> joined(const Dual<Rows>& upper, const Dual<Rows>& lower) {
  return {joined(upper.value, lower.value), joined(upper.slope, lower.slope)};
}

void multiply(Rows& rows, Eigen::Index i, Eigen::Index j, Complex factor) {
  rows(i, j) *= factor;
}

void multiply(Dual<Rows>& rows, Eigen::Index i, Eigen::Index j, const Dual<Complex>& factor) {
  rows.slope(i, j) = factor.value * rows.slope(i, j) + factor.slope * rows.value(i, j);
  rows.value(i, j) *= factor.value;
}

/// Radiance of both ways, in rows.
template <typename R>
struct BothWays {
  R down, up;

  BothWays& operator+=(const BothWays& other) {
    down += other.down;
    up += other.up;
    return *this;
  }
};

template <typename C, typename R>
BothWays<R> scaled(const std::vector<C>& factor, const BothWays<R>& rows) {
  return {flatspeckle::mc::scaled(factor, rows.down), flatspeckle::mc::scaled(factor, rows.up)};
}

template <typename Number, typename C>
std::vector<C> times(const Number& factor, std::vector<C> list) {
  for (C& value : list) value = factor * value;
  return list;
}

/// exp(depth rate) of each.
template <typename Number, typename C>
std::vector<C> damping(std::vector<C> rates, const Number& depth) {
  using std::exp;
  for (C& rate : rates) rate = exp(depth * rate);
  return rates;
}

/// int_0^1 exp(rate u) u^power du by its series.
template <typename C>
C moment(const C& rate, std::size_t power) {
  constexpr int terms = 30;
  C sum{}, term = exp(C{});
  for (int i = 0; i < terms; ++i) {
    sum += term / static_cast<double>(static_cast<std::size_t>(i) + power + 1);
    term = term * rate / static_cast<double>(i + 1);
  }
  return sum;
}

/// A layer by what leaves it, the same from above and below: `reflected` and `lost` = 1 -
/// transmitted radiance (of a thin layer small, so that albedo 1 balances to rounding of it), and
/// what leaves of the lights and, turned round, of the views.
template <typename Number>
class Layer {
 public:
  using Operator = TransportOperatorOf<Number>;
  using Waves = PairWavesOf<Number>;
  using M = MatrixOf<Number>;
  using R = RowsOf<Number>;
  using C = ComplexOf<Number>;

  Layer(const Operator& medium, RealOf<Number> depth, const Waves& lights, const Waves& views);
  /// Puts another one on top.
  void double_depth();
  LayerResponseOf<Number> response() const {
    return {of_lights(leaves_.up), of_lights(leaves_.down), collected_};
  }

 private:
  void start_radiance(const Operator& medium);
  void start_pairs(const Operator& medium);
  R collected_in_series(const std::vector<BothWays<R>>& series) const;
  R contracted(const R& views, const R& lights) const;
  std::vector<C> rates() const;
  R of_lights(const R& rows) const {
    return linear([this](const Rows& r) -> Rows { return r.topRows(lights_); }, rows);
  }
  R of_views(const R& rows) const {
    return linear([this](const Rows& r) -> Rows { return r.bottomRows(r.rows() - lights_); }, rows);
  }

  RealOf<Number> depth_;
  Eigen::Index lights_, even_;
  Waves waves_;
  M reflected_, lost_, transmitted_;
  BothWays<R> leaves_;
  R collected_;
};

template <typename Number>
Layer<Number>::Layer(const Operator& medium, RealOf<Number> depth, const Waves& lights,
                     const Waves& views)
    : depth_(depth),
      lights_(static_cast<Eigen::Index>(lights.top.size())),
      even_(medium.even),
      waves_{joined(lights.top, views.top), joined(lights.bottom, views.bottom),
             joined(lights.down, views.down), joined(lights.up, views.up)} {
  start_radiance(medium);
  start_pairs(medium);
}

/// Mirrors in its middle make two problems of a layer: D = m S and S = n D at the top for equal and
/// for opposite radiance from both sides, m = (d/2) y tanh_ratio(x y d^2/4).
template <typename Number>
void Layer<Number>::start_radiance(const Operator& medium) {
  const RealOf<Number> half = depth_ / 2.0;
  const auto loss = [&](const M& inner, const M& outer) {
    return share(M(half * product(outer, tanh_ratio(M(half * half * product(inner, outer))))));
  };
  const M equal = loss(medium.x, medium.y), opposite = loss(medium.y, medium.x);
  reflected_ = opposite - equal;
  lost_ = opposite + equal;
  transmitted_ = identity_like(lost_) - lost_;
}

/// Power series in z of what lights feed into a layer that no radiance enters at the top; then
/// radiance enters from below so that none enters there in sum.
template <typename Number>
void Layer<Number>::start_pairs(const Operator& medium) {
  constexpr int terms = 30;
  const M a = 0.5 * (medium.x + medium.y), b = 0.5 * (medium.x - medium.y);
  auto fed = scaled(damping(waves_.bottom, depth_), BothWays<R>{waves_.down, -waves_.up});
  std::vector<BothWays<R>> series;
  BothWays<R> sum{0.0 * fed.down, 0.0 * fed.up}, term = sum;
  for (int j = 0; j < terms; ++j) {
    const RealOf<Number> step = depth_ / (j + 1.0);
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
template <typename Number>
RowsOf<Number> Layer<Number>::collected_in_series(const std::vector<BothWays<R>>& series) const {
  const R from_up = of_views(waves_.down), from_down = of_views(waves_.up);
  const auto rate = times(depth_, rates()), start = damping(waves_.bottom, depth_);
  R collected = linear(
      [this](const Rows& views) -> Rows { return Rows::Zero(views.rows(), lights_); }, from_up);
  for (std::size_t j = 0; j < series.size(); ++j) {
    std::vector<C> factor;
    for (auto v = static_cast<std::size_t>(lights_); v < rate.size(); ++v)
      factor.push_back(depth_ * (start[v] * moment(rate[v], j + 1)));
    collected += flatspeckle::mc::scaled(
        factor, R(contracted(from_down, series[j].down) + contracted(from_up, series[j].up)));
  }
  return collected;
}

/// [view][light]; of the signs that rows have, one is turned back.
template <typename Number>
RowsOf<Number> Layer<Number>::contracted(const R& views, const R& lights) const {
  const auto turned = [this](Rows rows) {
    for (Eigen::Index j = even_; j < rows.cols(); ++j)
      for (Eigen::Index i = 0; i < rows.rows(); ++i) rows(i, j) = -rows(i, j);
    return rows;
  };
  return product_transposed(views, linear(turned, lights));
}

/// Of waves along z from the bottom to the top.
template <typename Number>
std::vector<ComplexOf<Number>> Layer<Number>::rates() const {
  std::vector<C> list;
  for (std::size_t i = 0; i < waves_.top.size(); ++i)
    list.push_back(waves_.top[i] - waves_.bottom[i]);
  return list;
}

/// Of radiance between the halves: down = r lights' + reflected up, up likewise; (1 - r^2)^-1 sums
/// it.
template <typename Number>
void Layer<Number>::double_depth() {
  const M one = identity_like(lost_), sums = inverse(M(one - product(reflected_, reflected_))),
          down = product(sums, transmitted_), up = product(reflected_, down);
  const auto upper = damping(waves_.bottom, depth_), lower = damping(waves_.top, depth_);
  const BothWays<R> above = scaled(upper, leaves_), below = scaled(lower, leaves_);
  const R meets_down = above.down + product(below.up, reflected_),
          meets_up = below.up + product(above.down, reflected_);
  const auto lights = static_cast<std::size_t>(lights_);
  for (std::size_t l = 0; l < lights; ++l)
    for (std::size_t v = lights; v < upper.size(); ++v)
      multiply(collected_, static_cast<Eigen::Index>(v - lights), static_cast<Eigen::Index>(l),
               upper[v] * upper[l] + lower[v] * lower[l]);
  collected_ += contracted(of_views(above.down), product(of_lights(meets_up), sums)) +
                contracted(of_views(below.up), product(of_lights(meets_down), sums));
  leaves_ = {below.down + product(meets_down, down), above.up + product(meets_up, down)};
  lost_ = 2.0 * lost_ - product(lost_, lost_) - product(transmitted_, product(reflected_, up));
  reflected_ += product(transmitted_, up);
  transmitted_ = one - lost_;
  depth_ = 2.0 * depth_;
}

template <typename Number>
double fastest_rate(const TransportOperatorOf<Number>& medium, const PairWavesOf<Number>& waves) {
  double rate = medium.fastest;
  for (std::size_t i = 0; i < waves.top.size(); ++i)
    rate = std::max(rate, std::abs(value_of(waves.top[i] - waves.bottom[i])));
  return rate;
}

}  // namespace

template <typename Number>
LayerResponseOf<Number> layer_response(const TransportOperatorOf<Number>& medium,
                                       RealOf<Number> depth, const PairWavesOf<Number>& lights,
                                       const PairWavesOf<Number>& views) {
  const double rate = std::max(fastest_rate(medium, lights), fastest_rate(medium, views));
  const int doublings =
      std::max(0, static_cast<int>(std::ceil(std::log2(value_of(depth) * rate / 2))));
  Layer<Number> layer(medium, std::ldexp(1.0, -doublings) * depth, lights, views);
  for (int i = 0; i < doublings; ++i) {
    stop_if_interrupted();
    layer.double_depth();
  }
  return layer.response();
}

template LayerResponse layer_response(const TransportOperator&, double, const PairWaves&,
                                      const PairWaves&);
template LayerResponseOf<Complex> layer_response(const TransportOperatorOf<Complex>&, double,
                                                 const PairWavesOf<Complex>&,
                                                 const PairWavesOf<Complex>&);
template LayerResponseOf<Dual<double>> layer_response(const TransportOperatorOf<Dual<double>>&,
                                                      Dual<double>,
                                                      const PairWavesOf<Dual<double>>&,
                                                      const PairWavesOf<Dual<double>>&);

}  // namespace flatspeckle::mc

#include "mc/slab/adding/layer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/run/interrupt.h"

namespace flatspeckle::mc {

namespace {

/// Returns tanh(sqrt(k)) / sqrt(k) of a matrix k by Lambert's continued fraction. The error is
/// 4e-12 for eigenvalues on the unit circle and decreases to rounding error inside the circle.
template <typename M>
M tanh_ratio(const M& k) {
  const M one = identity_like(k), k2 = product(k, k), k3 = product(k2, k);
  return FactorsOf<M>(M(135135.0 * one + 62370.0 * k + 3150.0 * k2 + 28.0 * k3))
      .before(M(135135.0 * one + 17325.0 * k + 378.0 * k2 + k3));
}

/// Returns (1 + a)^-1 a.
template <typename M>
M share(const M& a) {
  return FactorsOf<M>(M(identity_like(a) + a)).before(a);
}

using flatspeckle::concatenated;  // overload for rows, beside the one for lists below

template <typename T>
std::vector<T> concatenated(std::vector<T> list, const std::vector<T>& rest) {
  list.insert(list.end(), rest.begin(), rest.end());
  return list;
}

void multiply(Rows& rows, Eigen::Index i, Eigen::Index j, Complex factor) {
  rows(i, j) *= factor;
}

void multiply(Dual<Rows>& rows, Eigen::Index i, Eigen::Index j, const Dual<Complex>& factor) {
  rows.derivative(i, j) =
      factor.value * rows.derivative(i, j) + factor.derivative * rows.value(i, j);
  rows.value(i, j) *= factor.value;
}

/// Downward and upward radiance, one row per illumination or view.
template <typename R>
struct UpAndDown {
  R down, up;
};

/// Sum and difference of downward and upward radiance: S and D of TransportOperatorOf.
template <typename R>
struct Mirrored {
  R sum, difference;

  UpAndDown<R> up_and_down() const { return {0.5 * (sum + difference), 0.5 * (sum - difference)}; }
};

using flatspeckle::scaled;  // overload for plain rows, beside the one for UpAndDown below

/// Adds the rows r, r + count, .. for each r below `count`.
template <typename R>
R summed_rows(const R& rows, Eigen::Index count) {
  const auto sum = [count](const Rows& all) {
    Rows found = all.topRows(count);
    for (Eigen::Index first = count; first < all.rows(); first += count)
      found += all.middleRows(first, count);
    return found;
  };
  return linear(sum, rows);
}
template <typename R>
R summed_columns(const R& rows, Eigen::Index count) {
  const auto sum = [count](const Rows& all) {
    Rows found = all.leftCols(count);
    for (Eigen::Index first = count; first < all.cols(); first += count)
      found += all.middleCols(first, count);
    return found;
  };
  return linear(sum, rows);
}

template <typename C, typename R>
UpAndDown<R> scaled(const std::vector<C>& factor, const UpAndDown<R>& rows) {
  return {scaled(factor, rows.down), scaled(factor, rows.up)};
}

template <typename Number, typename C>
std::vector<C> times(const Number& factor, std::vector<C> list) {
  for (C& value : list) value = factor * value;
  return list;
}

/// Returns exp(depth * rate) for each rate.
template <typename Number, typename C>
std::vector<C> damping(std::vector<C> rates, const Number& depth) {
  using std::exp;
  for (C& rate : rates) rate = exp(depth * rate);
  return rates;
}

/// Returns int_0^1 exp(rate u) u^power du for power = 1 .. count. The integral of the highest power
/// is computed by its power series, the others by downward recurrence.
template <typename C>
std::vector<C> moments(const C& rate, int count) {
  std::vector<C> moment(static_cast<std::size_t>(count));
  constexpr int terms = 30;
  const C start = exp(C{}), end = exp(rate);
  C term = start;
  for (int i = 0; i < terms; ++i) {
    moment.back() += term / (i + count + 1.0);
    term = term * rate / (i + 1.0);
  }
  for (std::size_t p = moment.size() - 1; p > 0; --p)
    moment[p - 1] = (end - rate * moment[p]) / (static_cast<double>(p) + 1);
  return moment;
}

/// Flips the signs of all but the first `even` columns.
template <typename R>
R turned(const R& rows, Eigen::Index even) {
  const auto turn = [even](Rows r) {
    r.rightCols(r.cols() - even) = -r.rightCols(r.cols() - even);
    return r;
  };
  return linear(turn, rows);
}

/// Returns the scalar product of each row of `views` with each row of `lights`, [view][light]. The
/// sign flip of PairWavesOf is first undone in `views`.
template <typename R>
R contracted(const R& views, const R& lights, Eigen::Index even) {
  return product_transposed(turned(views, even), lights);
}

/// Response of one or several layers: matrices of reflection and transmission, by which rows of
/// radiance are multiplied from the right; the radiance that leaves, caused by the illuminations
/// or, in the time-reversed problem, by the views; and the signal that the views collect.
template <typename Number>
struct Sheet {
  MatrixOf<Number> top, bottom;  ///< reflection at the top; reflection at the bottom
  MatrixOf<Number> down, up;     ///< transmission downwards; transmission upwards
  UpAndDown<RowsOf<Number>> lights, views;
  RowsOf<Number> collected;
};

/// Response of a homogeneous layer. With reflection R and transmission T, R + T = 1 - equal_ is the
/// response to equal radiance on both faces, and R - T = opposite_ - 1 is the response to opposite
/// radiance. For a thin layer equal_ and opposite_ are small, so that at albedo 1 power is
/// conserved to rounding error. transmitted_ is T, computed from equal_ and opposite_; in thick
/// layers, where T is small, it is computed by its own recurrence. leaves_ is the radiance that
/// leaves, caused by the illuminations or, in the time-reversed problem, by the views.
template <typename Number>
class Layer {
 public:
  using Operator = TransportOperatorOf<Number>;
  using Waves = PairWavesOf<Number>;
  using M = MatrixOf<Number>;
  using R = RowsOf<Number>;
  using C = ComplexOf<Number>;

  Layer(const Operator& medium, RealOf<Number> depth, const Waves& lights, const Waves& views);
  /// Doubles the depth by adding an identical layer on top.
  void double_depth();
  /// Returns the response of this layer to pairs of illuminations and of views (PairWavesOf).
  Sheet<Number> sheet(const Waves& lights, const Waves& views) const;

 private:
  void start_radiance(const Operator& medium);
  M reflected() const { return 0.5 * (opposite_ - equal_); }
  M rest() const { return identity_like(equal_) - 0.5 * (opposite_ + equal_); }
  void start_pairs(const Operator& medium);
  R collected_in_series(const std::vector<Mirrored<R>>& series) const;
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
  M equal_, opposite_, transmitted_;
  UpAndDown<R> leaves_;
  R collected_;
};

template <typename Number>
Layer<Number>::Layer(const Operator& medium, RealOf<Number> depth, const Waves& lights,
                     const Waves& views)
    : depth_(depth),
      lights_(static_cast<Eigen::Index>(lights.top.size())),
      even_(medium.even),
      waves_{concatenated(lights.top, views.top),
             concatenated(lights.bottom, views.bottom),
             concatenated(lights.down, views.down),
             concatenated(lights.up, views.up),
             {}} {
  start_radiance(medium);
  start_pairs(medium);
}

/// Computes the response to incident radiance. With the symbols of TransportOperatorOf, at the top
/// of a layer of depth d, D = m S if equal radiance is incident on both faces, and S = n D if it is
/// opposite, where m = (d/2) y f, n = (d/2) f x and f = tanh_ratio(x y d^2/4).
template <typename Number>
void Layer<Number>::start_radiance(const Operator& medium) {
  const RealOf<Number> half = depth_ / 2.0;
  const M ratio = half * tanh_ratio(M(half * half * product(medium.x, medium.y)));
  equal_ = 2.0 * share(product(medium.y, ratio));
  opposite_ = 2.0 * share(product(ratio, medium.x));
  transmitted_ = rest();
}

/// Computes the response to illuminations and views. First, the radiance that they cause is summed
/// as a power series in z, with downward and upward radiance set to 0 at the top. In fact no upward
/// radiance enters at the bottom. Therefore the upward radiance of the series at the bottom is
/// cancelled by incident radiance of the opposite sign.
template <typename Number>
void Layer<Number>::start_pairs(const Operator& medium) {
  constexpr int terms = 30;
  const auto start = damping(waves_.bottom, depth_);
  Mirrored<R> fed{scaled(start, R(waves_.down - waves_.up)),
                  scaled(start, R(waves_.down + waves_.up))},
      sum{0.0 * fed.sum, 0.0 * fed.sum}, term = sum;
  std::vector<Mirrored<R>> series;
  for (int j = 0; j < terms; ++j) {
    const RealOf<Number> step = depth_ / (j + 1.0);
    const auto next = times(step, rates());
    term = {step * (fed.sum - product(term.difference, medium.x)),
            step * (fed.difference - product(term.sum, medium.y))};
    fed = {scaled(next, fed.sum), scaled(next, fed.difference)};
    sum.sum += term.sum;
    sum.difference += term.difference;
    series.push_back({of_lights(term.sum), of_lights(term.difference)});
  }
  const auto [down, up] = sum.up_and_down();
  leaves_ = {down - product(up, reflected()), -product(up, transmitted_)};
  collected_ =
      collected_in_series(series) - contracted(of_views(leaves_.down), of_lights(up), even_);
}

/// Returns the signal that views collect from the radiance sum_j series[j] (z / depth)^(j+1).
template <typename Number>
RowsOf<Number> Layer<Number>::collected_in_series(const std::vector<Mirrored<R>>& series) const {
  const R sums = turned(R(0.5 * of_views(waves_.up + waves_.down)), even_),
          differences = turned(R(0.5 * of_views(waves_.up - waves_.down)), even_);
  const auto rate = times(depth_, rates()), start = damping(waves_.bottom, depth_);
  std::vector<std::vector<C>> factors(series.size());
  for (auto v = static_cast<std::size_t>(lights_); v < rate.size(); ++v) {
    const auto moment = moments(rate[v], static_cast<int>(series.size()));
    for (std::size_t j = 0; j < series.size(); ++j)
      factors[j].push_back(depth_ * (start[v] * moment[j]));
  }
  R collected = 0.0 * product_transposed(sums, series.front().sum);
  for (std::size_t j = 0; j < series.size(); ++j)
    collected += scaled(factors[j], R(product_transposed(sums, series[j].sum) +
                                      product_transposed(differences, series[j].difference)));
  return collected;
}

/// Returns, for each illumination and view, the rate r of its exponential change exp(r z) with
/// depth.
template <typename Number>
std::vector<ComplexOf<Number>> Layer<Number>::rates() const {
  std::vector<C> list;
  for (std::size_t i = 0; i < waves_.top.size(); ++i)
    list.push_back(waves_.top[i] - waves_.bottom[i]);
  return list;
}

/// Combines two equal halves. If the upper half emits d0 down and the lower half emits u0 up, the
/// radiance between them is down = d0 + r up and up = u0 + r down, with the reflection r of a half.
/// Therefore down + up = (1 - r)^-1 (d0 + u0), and down - up = (1 + r)^-1 (d0 - u0).
template <typename Number>
void Layer<Number>::double_depth() {
  const M reflects = reflected(), one = identity_like(reflects);
  const FactorsOf<M> of_sums(M(one - reflects)), of_differences(M(one + reflects));
  const auto upper = damping(waves_.bottom, depth_), lower = damping(waves_.top, depth_);
  const UpAndDown<R> above = scaled(upper, leaves_), below = scaled(lower, leaves_);
  const Mirrored<R> between{of_sums.after(above.down + below.up),
                            of_differences.after(above.down - below.up)};
  const auto [down, up] = between.up_and_down();
  const auto lights = static_cast<std::size_t>(lights_);
  for (std::size_t l = 0; l < lights; ++l)
    for (std::size_t v = lights; v < upper.size(); ++v)
      multiply(collected_, static_cast<Eigen::Index>(v - lights), static_cast<Eigen::Index>(l),
               upper[v] * upper[l] + lower[v] * lower[l]);
  collected_ += contracted(of_views(above.down), of_lights(up), even_) +
                contracted(of_views(below.up), of_lights(down), even_);
  leaves_ = {below.down + product(down, transmitted_), above.up + product(up, transmitted_)};
  const M by_sums = of_sums.before(transmitted_),
          by_differences = of_differences.before(transmitted_);
  equal_ += product(equal_, by_sums);
  opposite_ += product(opposite_, by_differences);
  const bool deep = value_of(depth_) > 1;
  transmitted_ = deep ? M(0.5 * product(transmitted_, M(by_sums + by_differences))) : rest();
  depth_ = 2.0 * depth_;
}

template <typename Number>
Sheet<Number> Layer<Number>::sheet(const Waves& lights, const Waves& views) const {
  R collected = scaled(views.factor, collected_);
  for (std::size_t l = 0; l < lights.factor.size(); ++l)
    for (std::size_t v = 0; v < views.factor.size(); ++v)
      multiply(collected, static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(l),
               lights.factor[l]);
  const M back = reflected();
  const auto of_pairs = [](const Waves& waves, const R& rows) {
    return summed_rows(R(scaled(waves.factor, rows)), waves.pairs);
  };
  return {back,
          back,
          transmitted_,
          transmitted_,
          {of_pairs(lights, of_lights(leaves_.down)), of_pairs(lights, of_lights(leaves_.up))},
          {of_pairs(views, of_views(leaves_.down)), of_pairs(views, of_views(leaves_.up))},
          summed_columns(summed_rows(collected, views.pairs), lights.pairs)};
}

/// Returns the response of two stacked layers or groups of layers. even: number of columns of
/// radiance whose sign is not flipped.
template <typename Number>
Sheet<Number> stacked(const Sheet<Number>& above, const Sheet<Number>& below, Eigen::Index even) {
  using M = MatrixOf<Number>;
  using UpAndDownRows = UpAndDown<RowsOf<Number>>;
  const M one = identity_like(above.bottom);
  const FactorsOf<M> of_down(M(one - product(below.top, above.bottom))),
      of_up(M(one - product(above.bottom, below.top)));
  const auto between = [&](const UpAndDownRows& upper, const UpAndDownRows& lower) {
    return UpAndDownRows{of_down.after(upper.down + product(lower.up, above.bottom)),
                         of_up.after(lower.up + product(upper.down, below.top))};
  };
  const auto leaving = [&](const UpAndDownRows& upper, const UpAndDownRows& lower,
                           const UpAndDownRows& middle) {
    return UpAndDownRows{lower.down + product(middle.down, below.down),
                         upper.up + product(middle.up, above.up)};
  };
  const UpAndDownRows lights = between(above.lights, below.lights);
  return {above.top + product(above.down, of_down.before(product(below.top, above.up))),
          below.bottom + product(below.up, of_up.before(product(above.bottom, below.down))),
          product(above.down, of_down.before(below.down)),
          product(below.up, of_up.before(above.up)),
          leaving(above.lights, below.lights, lights),
          leaving(above.views, below.views, between(above.views, below.views)),
          above.collected + below.collected + contracted(above.views.down, lights.up, even) +
              contracted(below.views.up, lights.down, even)};
}

template <typename Number>
double fastest_rate(const TransportOperatorOf<Number>& medium, const PairWavesOf<Number>& waves) {
  double rate = medium.fastest;
  for (std::size_t i = 0; i < waves.top.size(); ++i)
    rate = std::max(rate, std::abs(value_of(waves.top[i] - waves.bottom[i])));
  return rate;
}

template <typename Number>
Layer<Number> doubled(const HomogeneousLayerOf<Number>& layer) {
  const double rate =
      std::max(fastest_rate(layer.medium, layer.lights), fastest_rate(layer.medium, layer.views));
  const int doublings =
      std::max(0, static_cast<int>(std::ceil(std::log2(value_of(layer.depth) * rate / 2))));
  Layer<Number> part(layer.medium, std::ldexp(1.0, -doublings) * layer.depth, layer.lights,
                     layer.views);
  for (int i = 0; i < doublings; ++i) {
    stop_if_interrupted();
    part.double_depth();
  }
  return part;
}

/// Returns `rows` with column j multiplied by factor[j].
template <typename M>
M scaled_columns(const M& matrix, const Eigen::VectorXd& factor) {
  const auto scale = [&factor](auto all) {
    for (Eigen::Index j = 0; j < all.cols(); ++j) all.col(j) *= factor[j];
    return all;
  };
  return linear(scale, matrix);
}

template <typename M>
M blocks(const M& a, const M& b, const M& c, const M& d) {
  M all(a.rows() + c.rows(), a.cols() + b.cols());
  all << a, b, c, d;
  return all;
}
template <typename M>
Dual<M> blocks(const Dual<M>& a, const Dual<M>& b, const Dual<M>& c, const Dual<M>& d) {
  return {blocks(a.value, b.value, c.value, d.value),
          blocks(a.derivative, b.derivative, c.derivative, d.derivative)};
}

/// Returns a face inside a stack, between media with `above` and `below` ordinates for each
/// function of direction. pairs: an element with the numbers of illuminations and views.
template <typename Number>
Sheet<Number> face_sheet(const Eigen::VectorXd& reflectance, Eigen::Index functions,
                         Eigen::Index above, Eigen::Index below, const Sheet<Number>& pairs) {
  using M = MatrixOf<Number>;
  using R = RowsOf<Number>;
  Matrix top = Matrix::Identity(functions * above, functions * above),
         bottom = Matrix::Identity(functions * below, functions * below),
         down = Matrix::Zero(functions * above, functions * below);
  for (Eigen::Index f = 0; f < functions; ++f)
    for (Eigen::Index j = 0; j < std::min(above, below); ++j) {
      top(f * above + j, f * above + j) = bottom(f * below + j, f * below + j) = reflectance[j];
      down(f * above + j, f * below + j) = 1 - reflectance[j];
    }
  const auto dark = [](const R& rows, Eigen::Index columns) {
    return linear([columns](const Rows& like) -> Rows { return Rows::Zero(like.rows(), columns); },
                  rows);
  };
  const auto no_radiance = [&](const UpAndDown<R>& like) {
    return UpAndDown<R>{dark(like.down, functions * below), dark(like.up, functions * above)};
  };
  const auto exact = [](const Matrix& real) -> M { return flatspeckle::times(Number{1}, real); };
  return {exact(top),
          exact(bottom),
          exact(down),
          exact(Matrix(down.transpose())),
          no_radiance(pairs.lights),
          no_radiance(pairs.views),
          0.0 * pairs.collected};
}

Eigen::VectorXd repeated(const Eigen::VectorXd& list, Eigen::Index times) {
  return list.replicate(times, 1);
}

/// Returns the response of a stack between two outer faces, whose reflectances at the ordinates
/// inside are `top` and `bottom`. Radiance a enters the stack from the upper face and b from the
/// lower one: a is the reflected part of all radiance that leaves upwards, b of that which leaves
/// downwards.
template <typename Number>
LayerResponseOf<Number> enclosed(const Sheet<Number>& stack, const Eigen::VectorXd& top,
                                 const Eigen::VectorXd& bottom, Eigen::Index even_top,
                                 Eigen::Index even_bottom) {
  using M = MatrixOf<Number>;
  using R = RowsOf<Number>;
  const FactorsOf<M> factors(
      blocks(M(identity_like(stack.top) - scaled_columns(stack.top, top)),
             M(-1.0 * scaled_columns(stack.down, bottom)), M(-1.0 * scaled_columns(stack.up, top)),
             M(identity_like(stack.bottom) - scaled_columns(stack.bottom, bottom))));
  const R both = factors.after(
      beside(scaled_columns(stack.lights.up, top), scaled_columns(stack.lights.down, bottom)));
  const Eigen::Index first = top.size(), second = bottom.size();
  const R a = linear([first](const Rows&r) -> Rows { return r.leftCols(first); }, both),
          b = linear([second](const Rows&r) -> Rows { return r.rightCols(second); }, both);
  const Eigen::VectorXd of_top = (1 - top.array()).matrix(),
                        of_bottom = (1 - bottom.array()).matrix();
  return {scaled_columns(R(stack.lights.up + product(a, stack.top) + product(b, stack.up)), of_top),
          scaled_columns(R(stack.lights.down + product(a, stack.down) + product(b, stack.bottom)),
                         of_bottom),
          stack.collected + contracted(stack.views.up, a, even_top) +
              contracted(stack.views.down, b, even_bottom)};
}

}  // namespace

template <typename Number>
LayerResponseOf<Number> response_of(const std::vector<HomogeneousLayerOf<Number>>& layers,
                                    const FaceReflectances& faces) {
  const auto& reflectance = faces.reflectance;
  const auto ordinates = [&](std::size_t l) {
    return value_of(layers[l].medium.x).rows() / faces.functions;
  };
  std::optional<Sheet<Number>> all;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const auto& layer = layers[l];
    const Sheet<Number> sheet = doubled(layer).sheet(layer.lights, layer.views);
    if (l > 0 && !reflectance.empty() && !reflectance[l].isZero(0))
      all = stacked(
          *all, face_sheet(reflectance[l], faces.functions, ordinates(l - 1), ordinates(l), sheet),
          layers[l - 1].medium.even);
    all = l > 0 ? stacked(*all, sheet, layer.medium.even) : sheet;
  }
  if (reflectance.empty()) return {all->lights.up, all->lights.down, all->collected};
  return enclosed(*all, repeated(reflectance.front(), faces.functions),
                  repeated(reflectance.back(), faces.functions), layers.front().medium.even,
                  layers.back().medium.even);
}

template LayerResponseOf<double> response_of(const std::vector<HomogeneousLayerOf<double>>&,
                                             const FaceReflectances&);
template LayerResponseOf<Complex> response_of(const std::vector<HomogeneousLayerOf<Complex>>&,
                                              const FaceReflectances&);
template LayerResponseOf<Dual<double>> response_of(
    const std::vector<HomogeneousLayerOf<Dual<double>>>&, const FaceReflectances&);

}  // namespace flatspeckle::mc

#include "mc/distance/layered_radiance.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

namespace {

/// Returns the integral over z from 0 to h of exp(-a z - b (h - z)).
Complex exponential_integral(Complex a, Complex b, double h) {
  const Complex difference = (b - a) * h;
  if (std::abs(difference) < 1e-4)
    return h * std::exp(-a * h) * (1.0 - difference / 2.0 + difference * difference / 6.0);
  return (std::exp(-a * h) - std::exp(-b * h)) / (b - a);
}

/// Depths in a layer, with weights, for integrals of sums of exponentials that decay from its faces
/// at rates from `slowest` to `fastest`: panels from each face double in length. Relative error
/// 1e-6. Where nothing reaches the lower face, panels go from the upper face alone.
QuadratureRule graded_depths(double thickness, double slowest, double fastest) {
  constexpr double deepest = 20;  // decay lengths
  static const QuadratureRule panel = gauss_legendre(4);
  const bool is_deep = thickness * slowest > deepest;
  const double last = is_deep ? deepest / slowest : thickness / 2;
  QuadratureRule rule;
  const auto add = [&](double depth, double weight) {
    rule.node.push_back(depth);
    rule.weight.push_back(weight);
  };
  for (double from = 0, length = 4 / fastest; from < last; from += length, length = from) {
    length = std::min(length, last - from);
    for (std::size_t i = 0; i < panel.node.size(); ++i) {
      const double depth = from + length * panel.node[i], weight = length * panel.weight[i];
      add(depth, weight);
      if (!is_deep) add(thickness - depth, weight);
    }
  }
  return rule;
}

/// Returns exp(-decay depth), or 0 where it does not matter.
Complex decayed(Complex decay, double depth) {
  constexpr double most = 46;
  return decay.real() * depth < most ? std::exp(-decay * depth) : 0;
}

/// Returns the coefficients of light along +z in Y_l0, which is 1 per steradian on the sphere.
double along_axis(int l) {
  return std::sqrt((2 * l + 1) / (4 * std::numbers::pi));
}

}  // namespace

/// Solves for the amplitudes of modes. From the bottom up, it computes the reflection of each layer
/// with everything below it: up = reflection (attenuation down) + emission.
class LayeredRadiance::Solver {
 public:
  Solver(const LayeredRadiance& of, const Matrix& top, const Matrix& bottom);
  /// Makes a solver with another top face. If light reaches the bottom face, its matrix must be the
  /// same too.
  Solver(const Solver& other, const Matrix& top);
  std::vector<Amplitudes> operator()(const Sources& sources) const;
  bool reaches_bottom() const { return !is_dark(last()); }

 private:
  /// Reflection by one layer's lower face. Without a matrix, no light is reflected.
  struct Lower {
    Rows reflection;
    std::shared_ptr<const FactorsOf<Rows>> factors{};
    Rows flow_ratio, odd_ratio;
  };

  Lower lower(std::size_t layer) const;
  /// Returns the reflection, by the lower face, of light at the top of a layer.
  Rows seen_from_top(std::size_t layer) const {
    const Vector& x = attenuation_[layer];
    return x.asDiagonal() * lower_[layer].reflection * x.asDiagonal();
  }
  void set_top(const Matrix& top);
  bool is_dark(std::size_t layer) const {
    return attenuation_[layer].cwiseAbs().maxCoeff() < 1e-18;
  }
  /// Returns the inverse of the modes' flow, or of their odd coefficients, times a vector or
  /// matrix.
  template <typename M>
  Rows by_flow(std::size_t layer, const M& of) const {
    return inverse_norm(layer) * product(Rows(modes(layer).odd.transpose()), Rows(of));
  }
  template <typename M>
  Rows by_odd(std::size_t layer, const M& of) const {
    return inverse_norm(layer) * product(Rows(modes(layer).flow.transpose()), Rows(of));
  }
  Eigen::DiagonalMatrix<Complex, Eigen::Dynamic> inverse_norm(std::size_t layer) const {
    return Eigen::DiagonalMatrix<Complex, Eigen::Dynamic>(
        (2.0 / modes(layer).norm.array()).matrix());
  }
  const LayerModes& modes(std::size_t layer) const { return of_.modes_[layer]; }
  std::size_t last() const { return of_.modes_.size() - 1; }

  const LayeredRadiance& of_;
  const Matrix& bottom_;
  std::vector<Vector> attenuation_;
  std::vector<Lower> lower_;
  Rows upward_at_top_;  ///< condition of the top face applied to upward modes
  std::shared_ptr<const FactorsOf<Rows>> top_;
};

LayeredRadiance::Solver::Solver(const LayeredRadiance& of, const Matrix& top, const Matrix& bottom)
    : of_(of), bottom_(bottom), lower_(of.modes_.size()) {
  for (std::size_t k = 0; k <= last(); ++k) attenuation_.push_back(of.attenuation(k));
  for (std::size_t k = last() + 1; k-- > 0;) lower_[k] = lower(k);
  set_top(top);
}

LayeredRadiance::Solver::Solver(const Solver& other, const Matrix& top)
    : of_(other.of_),
      bottom_(other.bottom_),
      attenuation_(other.attenuation_),
      lower_(other.lower_) {
  set_top(top);
}

void LayeredRadiance::Solver::set_top(const Matrix& top) {
  const Rows reflected = top * modes(0).flow;
  upward_at_top_ = reflected - modes(0).odd;
  Rows condition = reflected + modes(0).odd;
  if (!is_dark(0)) condition += product(upward_at_top_, seen_from_top(0));
  top_ = std::make_shared<const FactorsOf<Rows>>(std::move(condition));
}

LayeredRadiance::Solver::Lower LayeredRadiance::Solver::lower(std::size_t layer) const {
  const LayerModes& own = modes(layer);
  if (layer == last()) {
    if (is_dark(layer)) return {};
    const Rows outside = bottom_ * own.flow;
    Lower found{{}, std::make_shared<const FactorsOf<Rows>>(Rows(own.odd + outside)), {}, {}};
    found.reflection = found.factors->before(own.odd - outside);
    return found;
  }
  Lower found{{}, {}, by_flow(layer, modes(layer + 1).flow), by_odd(layer, modes(layer + 1).odd)};
  Rows sum = found.flow_ratio, difference = found.odd_ratio;
  if (!is_dark(layer + 1)) {
    const Rows reflection = seen_from_top(layer + 1);
    sum += product(found.flow_ratio, reflection);
    difference -= product(found.odd_ratio, reflection);
  }
  found.factors = std::make_shared<const FactorsOf<Rows>>(Rows(sum + difference));
  found.reflection = found.factors->after(sum - difference);
  return found;
}

std::vector<LayeredRadiance::Amplitudes> LayeredRadiance::Solver::operator()(
    const Sources& sources) const {
  // From the bottom up: what each layer's lower face emits, and the change of downward amplitudes.
  std::vector<Vector> emission(last() + 1), change(last() + 1);
  for (std::size_t k = last() + 1; k-- > 0;) {
    emission[k] = Vector::Zero(modes(k).decay.size());
    if (k == last()) {
      if (!is_dark(k)) emission[k] = -lower_[k].factors->before(sources.bottom);
      continue;
    }
    const Vector arriving = attenuation_[k + 1].cwiseProduct(emission[k + 1]);
    const Vector flow = lower_[k].flow_ratio * arriving + by_flow(k, sources.jumps[k].flow).col(0),
                 odd = -lower_[k].odd_ratio * arriving + by_odd(k, sources.jumps[k].odd).col(0);
    change[k] = flow + odd;
    emission[k] = 0.5 * (flow - odd - lower_[k].reflection * change[k]);
  }
  std::vector<Amplitudes> found(last() + 1);
  found[0].down =
      top_->before(sources.top - upward_at_top_ * attenuation_[0].cwiseProduct(emission[0]));
  for (std::size_t k = 0; k <= last(); ++k) {
    const Vector arriving = attenuation_[k].cwiseProduct(found[k].down);
    found[k].up = emission[k];
    if (lower_[k].reflection.size() > 0) found[k].up += lower_[k].reflection * arriving;
    if (k < last()) found[k + 1].down = lower_[k].factors->before(2.0 * arriving - change[k]);
  }
  return found;
}

LayeredRadiance::LayeredRadiance(const RadianceHarmonics& harmonics,
                                 const std::vector<LayerLosses>& layers,
                                 std::vector<LayerModes> modes, const FaceConditions& top,
                                 const FaceConditions& bottom)
    : harmonics_(harmonics), layers_(layers), modes_(std::move(modes)), top_(top), bottom_(bottom) {
  double depth = 0;
  for (const LayerLosses& layer : layers_) {
    beam_.push_back(std::exp(-depth));
    depth += layer.beam * layer.thickness;
  }
}

LayeredRadiance::Vector LayeredRadiance::attenuation(std::size_t layer) const {
  return (-modes_[layer].decay * layers_[layer].thickness).array().exp();
}

/// Returns the source of radiance from the beam, at unit power, in Y_l0 for l = 0 .. order.
LayeredRadiance::Vector LayeredRadiance::beam_source(std::size_t layer) const {
  const LayerLosses& own = layers_[layer];
  Vector source(harmonics_.order() + 1);
  for (int l = 0; l <= harmonics_.order(); ++l)
    source[l] = (own.beam - own.loss[static_cast<std::size_t>(l)]) * along_axis(l);
  return source;
}

LayeredRadiance::Sources LayeredRadiance::sources_of_detector() const {
  const auto size = static_cast<Eigen::Index>(harmonics_.odd().size());
  Sources sources{top_.exit, Vector::Zero(size), {}};
  sources.jumps.assign(layers_.size(), {Vector::Zero(size), Vector::Zero(size)});
  return sources;
}

/// Solves the transport equation for the radiance that follows the beam. Its expansion in modes is
/// not used: at large q the modes are nearly dependent.
LayeredRadiance::Following LayeredRadiance::following(std::size_t layer) const {
  const LayerLosses& own = layers_[layer];
  const auto even = static_cast<Eigen::Index>(harmonics_.even().size()),
             odd = static_cast<Eigen::Index>(harmonics_.odd().size());
  Rows equation = harmonics_.transport(modes_[layer].frequency, own.beam);
  Vector source = Vector::Zero(even + odd);
  const Vector along = beam_source(layer);
  const auto add = [&](const std::vector<RadianceHarmonics::Index>& functions, Eigen::Index first) {
    for (std::size_t i = 0; i < functions.size(); ++i) {
      const auto [l, m] = functions[i];
      const Eigen::Index row = first + static_cast<Eigen::Index>(i);
      equation(row, row) += own.loss[static_cast<std::size_t>(l)];
      if (m == 0) source[row] = along[l];
    }
  };
  add(harmonics_.even(), 0);
  add(harmonics_.odd(), even);
  const Vector radiance = FactorsOf<Rows>(std::move(equation)).before(source);
  return {radiance.head(even), radiance.tail(odd), harmonics_.flow(radiance.head(even))};
}

LayeredRadiance::Sources LayeredRadiance::sources_of_beam(
    const std::vector<Following>& following) const {
  Sources sources;
  sources.top = -(following[0].odd + top_.admittance * following[0].flow);
  for (std::size_t k = 0; k + 1 < layers_.size(); ++k) {
    const double arriving = beam_[k + 1];
    sources.jumps.push_back({arriving * (following[k + 1].odd - following[k].odd),
                             arriving * (following[k + 1].flow - following[k].flow)});
  }
  const LayerLosses& last = layers_.back();
  const double arriving = beam_.back() * std::exp(-last.beam * last.thickness);
  sources.bottom = -arriving * (following.back().odd - bottom_.admittance * following.back().flow);
  return sources;
}

Complex LayeredRadiance::reflected_by_radiance() const {
  std::vector<Following> all;
  for (std::size_t k = 0; k < layers_.size(); ++k) all.push_back(following(k));
  const Solver solver(*this, top_.admittance, bottom_.admittance);
  const Amplitudes at_top = solver(sources_of_beam(all)).front();
  const Vector flow =
      modes_[0].flow * (at_top.down + attenuation(0).cwiseProduct(at_top.up)) + all[0].flow;
  return (top_.exit.transpose() * flow).value();
}

/// The source of radiance from the beam, integrated with the adjoint radiance.
Complex LayeredRadiance::power_from(std::size_t layer, const Amplitudes& adjoint) const {
  const LayerModes& modes = modes_[layer];
  const auto [loss, beam, thickness] = layers_[layer];
  Vector down = adjoint.down, up = adjoint.up;
  for (Eigen::Index j = 0; j < down.size(); ++j) {
    down[j] *= exponential_integral(modes.decay[j] + beam, 0, thickness);
    up[j] *= exponential_integral(beam, modes.decay[j], thickness);
  }
  const Vector even = modes.even * (up + down), odd = modes.odd * (up - down),
               source = beam_source(layer);
  Complex sum = 0;
  for (int l = 0; l <= harmonics_.order(); ++l) {
    const auto row = static_cast<Eigen::Index>(harmonics_.position({l, 0}));
    sum += source[l] * (l % 2 == 0 ? even : odd)[row];
  }
  return beam_[layer] * sum;
}

/// The perturbation of the transport equation by a change of the losses, integrated with the
/// adjoint radiance. Radiance is summed over modes at each depth: at large q, amplitudes of modes
/// are large and cancel, and sums over pairs of them would lose all digits.
LossDerivatives LayeredRadiance::derivatives(std::size_t layer, const Amplitudes& adjoint,
                                             const Amplitudes& radiance,
                                             const Following& following) const {
  const LayerModes& modes = modes_[layer];
  const auto [loss, beam, thickness] = layers_[layer];
  const QuadratureRule rule =
      graded_depths(thickness, std::min(beam, modes.decay.real().minCoeff()),
                    std::max(beam, modes.decay.cwiseAbs().maxCoeff()));
  const auto size = modes.decay.size(), nodes = static_cast<Eigen::Index>(rule.node.size());
  const Eigen::Map<const Eigen::RowVectorXd> depth(rule.node.data(), nodes),
      weight(rule.weight.data(), nodes);
  Rows from_top(size, nodes), from_bottom(size, nodes);
  for (Eigen::Index n = 0; n < nodes; ++n)
    for (Eigen::Index j = 0; j < size; ++j) {
      from_top(j, n) = decayed(modes.decay[j], depth[n]);
      from_bottom(j, n) = decayed(modes.decay[j], thickness - depth[n]);
    }
  const Eigen::RowVectorXd power = beam_[layer] * (-beam * depth).array().exp();
  LossDerivatives found{std::vector<Complex>(loss.size()), 0};
  const Vector source = beam_source(layer);
  const auto add = [&](const std::vector<RadianceHarmonics::Index>& functions, const Rows& mode,
                       const Vector& after_beam, double sign) {
    const auto at_depths = [&](const Vector& down, const Vector& up) {
      return product(mode, Rows(down.asDiagonal() * from_top + up.asDiagonal() * from_bottom));
    };
    const Rows adjoint_at = at_depths(sign * adjoint.down, adjoint.up) * weight.asDiagonal();
    Rows radiance_at = at_depths(radiance.down, sign * radiance.up);
    radiance_at += after_beam * power;
    for (std::size_t i = 0; i < functions.size(); ++i) {
      const auto [l, m] = functions[i];
      const auto row = adjoint_at.row(static_cast<Eigen::Index>(i));
      Complex& by_loss = found.loss[static_cast<std::size_t>(l)];
      by_loss -= row.cwiseProduct(radiance_at.row(static_cast<Eigen::Index>(i))).sum();
      if (m != 0) continue;
      const Complex with_beam = row.cwiseProduct(power).sum();
      by_loss -= along_axis(l) * with_beam;
      found.beam +=
          along_axis(l) * with_beam - source[l] * row.cwiseProduct(power).cwiseProduct(depth).sum();
    }
  };
  add(harmonics_.even(), modes.even, following.even, 1);
  add(harmonics_.odd(), modes.odd, following.odd, -1);
  return found;
}

Reflected LayeredRadiance::reflected(bool with_derivatives) const {
  const Matrix top = top_.admittance.transpose(), bottom = bottom_.admittance.transpose();
  const Solver transposed(*this, top, bottom);
  const std::vector<Amplitudes> adjoint = transposed(sources_of_detector());
  std::vector<Complex> powers;
  for (std::size_t k = 0; k < layers_.size(); ++k) powers.push_back(power_from(k, adjoint[k]));
  Reflected found{std::accumulate(powers.begin(), powers.end(), Complex(0)), {}};
  if (!with_derivatives) return found;
  std::vector<Following> following;
  for (std::size_t k = 0; k < layers_.size(); ++k) following.push_back(this->following(k));
  const Solver direct = transposed.reaches_bottom()
                            ? Solver(*this, top_.admittance, bottom_.admittance)
                            : Solver(transposed, top_.admittance);
  const std::vector<Amplitudes> radiance = direct(sources_of_beam(following));
  Complex below = found.power;
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    found.derivatives.push_back(derivatives(k, adjoint[k], radiance[k], following[k]));
    below -= powers[k];
    found.derivatives.back().beam -= layers_[k].thickness * below;
  }
  return found;
}

}  // namespace flatspeckle::mc

#include "mc/distance/layered_radiance.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

namespace flatspeckle::mc {

namespace {

/// Returns the integral over z from 0 to h of exp(-a z - b (h - z)).
Complex exponential_integral(Complex a, Complex b, double h) {
  const Complex difference = (b - a) * h;
  if (std::abs(difference) < 1e-4)
    return h * std::exp(-a * h) * (1.0 - difference / 2.0 + difference * difference / 6.0);
  return (std::exp(-a * h) - std::exp(-b * h)) / (b - a);
}

/// Returns the integral over z from 0 to h of z exp(-a z - b (h - z)).
Complex first_moment(Complex a, Complex b, double h) {
  const Complex difference = (b - a) * h;
  if (std::abs(difference) < 1e-3)
    return h * h * std::exp(-a * h) * (0.5 - difference / 6.0 + difference * difference / 24.0);
  return (h * std::exp(-a * h) - exponential_integral(a, b, h)) / (b - a);
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

/// Solves for the radiance that follows the beam, in modes: the transport operator is diagonal in
/// them.
LayeredRadiance::Following LayeredRadiance::following(std::size_t layer) const {
  const LayerModes& own = modes_[layer];
  const Vector source = beam_source(layer);
  Vector even = Vector::Zero(own.decay.size()), odd = even;
  for (int l = 0; l <= harmonics_.order(); ++l) {
    const auto row = static_cast<Eigen::Index>(harmonics_.position({l, 0}));
    if (l % 2 == 0)
      even += source[l] * own.even.row(row).transpose();
    else
      odd += source[l] * own.odd.row(row).transpose();
  }
  const double beam = layers_[layer].beam;
  const Vector down = (even + odd).array() / ((own.decay.array() - beam) * own.norm.array()),
               up = (even - odd).array() / ((own.decay.array() + beam) * own.norm.array());
  const Vector sum = down + up, difference = down - up;
  return {own.even * sum, own.odd * difference, own.flow * sum};
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

LayeredRadiance::Overlap LayeredRadiance::overlap(std::size_t layer,
                                                  const Amplitudes& adjoint) const {
  const LayerModes& modes = modes_[layer];
  const auto [loss, beam, thickness] = layers_[layer];
  const auto size = modes.decay.size();
  // Columns: integrals with the beam, and with depth times the beam.
  Rows down(size, 2), up(size, 2);
  for (Eigen::Index j = 0; j < size; ++j) {
    const Complex decay = modes.decay[j];
    down(j, 0) = adjoint.down[j] * exponential_integral(decay + beam, 0, thickness);
    down(j, 1) = adjoint.down[j] * first_moment(decay + beam, 0, thickness);
    up(j, 0) = adjoint.up[j] * exponential_integral(beam, decay, thickness);
    up(j, 1) = adjoint.up[j] * first_moment(beam, decay, thickness);
  }
  return {beam_[layer] * modes.even * (up + down), beam_[layer] * modes.odd * (up - down)};
}

Complex LayeredRadiance::axial_sum(const Overlap& overlap, Eigen::Index column,
                                   const Vector& factor) const {
  Complex sum = 0;
  for (int l = 0; l <= harmonics_.order(); ++l) {
    const auto row = static_cast<Eigen::Index>(harmonics_.position({l, 0}));
    sum += factor[l] * (l % 2 == 0 ? overlap.even : overlap.odd)(row, column);
  }
  return sum;
}

/// The perturbation of the transport equation by a change of the losses, integrated with the
/// adjoint radiance.
LossDerivatives LayeredRadiance::derivatives(std::size_t layer, const Amplitudes& adjoint,
                                             const Amplitudes& radiance, const Following& following,
                                             const Overlap& overlap) const {
  const LayerModes& modes = modes_[layer];
  const double thickness = layers_[layer].thickness;
  const auto size = modes.decay.size();
  const Vector x = attenuation(layer);
  Rows same(size, size), opposite(size, size);
  for (Eigen::Index j = 0; j < size; ++j)
    for (Eigen::Index i = 0; i < size; ++i) {
      const Complex a = modes.decay[i], b = modes.decay[j];
      const bool is_close = std::abs(b - a) * thickness < 1e-4;
      same(i, j) = (adjoint.down[i] * radiance.down[j] + adjoint.up[i] * radiance.up[j]) *
                   (1.0 - x[i] * x[j]) / (a + b);
      opposite(i, j) = (adjoint.down[i] * radiance.up[j] + adjoint.up[i] * radiance.down[j]) *
                       (is_close ? exponential_integral(a, b, thickness) : (x[i] - x[j]) / (b - a));
    }
  LossDerivatives found{std::vector<Complex>(layers_[layer].loss.size()), 0};
  const auto add = [&](const std::vector<RadianceHarmonics::Index>& functions, const Rows& mode,
                       const Rows& kernel, const Vector& after_beam, const Rows& with_beam) {
    const Vector all = product(mode, kernel).cwiseProduct(mode).rowwise().sum() +
                       after_beam.cwiseProduct(with_beam.col(0));
    for (std::size_t i = 0; i < functions.size(); ++i) {
      const auto [l, m] = functions[i];
      const auto row = static_cast<Eigen::Index>(i);
      const double beam = m == 0 ? along_axis(l) : 0;
      found.loss[static_cast<std::size_t>(l)] -= all[row] + beam * with_beam(row, 0);
    }
  };
  add(harmonics_.even(), modes.even, opposite + same, following.even, overlap.even);
  add(harmonics_.odd(), modes.odd, opposite - same, following.odd, overlap.odd);
  Vector axial(harmonics_.order() + 1);
  for (int l = 0; l <= harmonics_.order(); ++l) axial[l] = along_axis(l);
  found.beam = axial_sum(overlap, 0, axial) - axial_sum(overlap, 1, beam_source(layer));
  return found;
}

Reflected LayeredRadiance::reflected(bool with_derivatives) const {
  const Matrix top = top_.admittance.transpose(), bottom = bottom_.admittance.transpose();
  const Solver transposed(*this, top, bottom);
  const std::vector<Amplitudes> adjoint = transposed(sources_of_detector());
  std::vector<Overlap> overlaps;
  std::vector<Complex> powers;
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    overlaps.push_back(overlap(k, adjoint[k]));
    powers.push_back(axial_sum(overlaps[k], 0, beam_source(k)));
  }
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
    found.derivatives.push_back(derivatives(k, adjoint[k], radiance[k], following[k], overlaps[k]));
    below -= powers[k];
    found.derivatives.back().beam -= layers_[k].thickness * below;
  }
  return found;
}

}  // namespace flatspeckle::mc

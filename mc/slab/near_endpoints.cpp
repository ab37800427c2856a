#include "mc/slab/near_endpoints.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// Representation of a near illumination or sensor as a sum of plane waves.
class PlaneWaves {
 public:
  PlaneWaves(const Light& light, double k) : k_(k), point_(light.point), sign_(-1) {
    if (light.kind == Light::Kind::point) {
      strength_ = Complex(0, 1 / (4 * pi));
      return;
    }
    axis_ = light.angle;
    waist_ = light.waist;
    strength_ = k * waist_ / (2 * std::sqrt(pi));
  }
  PlaneWaves(const View& view, double k, double depth)
      : k_(k),
        point_(view.point),
        sign_(1),
        upward_(view.point.z < depth / 2),
        strength_(std::polar(std::sqrt(k / (2 * pi)), pi / 4)) {}

  /// Returns the direction with this sine in which light leaves the slab on the side of the sensor,
  /// or enters it from the illumination.
  double direction(double sine) const { return upward_ ? pi - std::asin(sine) : std::asin(sine); }

  Complex amplitude(double angle) const {
    const double phase = sign_ * k_ * dot(flatspeckle::direction(angle), point_);
    return strength_ * profile(angle) * std::polar(1.0, phase);
  }

  /// Whether the plane waves form a beam. The sines of their directions are then limited to
  /// axis_sine() +- half_width().
  bool is_beam() const { return waist_ > 0; }
  double axis_sine() const { return std::sin(axis_); }
  double half_width() const {
    // At half_width() from the axis the product of two beam profiles is exp(-nothing^2 / 2).
    constexpr double nothing = 6.5;
    return nothing / (k_ * waist_) * std::cos(axis_);
  }

 private:
  double profile(double angle) const {
    if (!is_beam()) return 1;
    const double tilt = k_ * waist_ * std::sin(angle - axis_) / 2;
    return std::cos(angle - axis_) * std::exp(-tilt * tilt);
  }

  double k_;
  Vec point_;
  double sign_;
  bool upward_ = false;
  Complex strength_;
  double axis_ = 0, waist_ = 0;
};

/// Returns a quadrature rule for integrals over pairs of plane waves whose sines differ by
/// `difference`. The nodes are means of the two sines. The rule is empty if no such waves exist.
QuadratureRule mean_sines(const PlaneWaves& a, const PlaneWaves& b, double difference, int order) {
  const double horizon = 1 - std::abs(difference) / 2;
  double low = -horizon, high = horizon;
  if (a.is_beam()) {
    const double middle = (a.axis_sine() + b.axis_sine()) / 2,
                 half = std::max(a.half_width(), b.half_width());
    low = std::max(low, middle - half);
    high = std::min(high, middle + half);
  }
  if (low >= high) return {};
  // The mean sine is replaced by horizon sin(angle), because the integrand is steep at both ends,
  // where one of the waves is parallel to the faces.
  const double from = std::asin(low / horizon), to = std::asin(high / horizon);
  QuadratureRule nodes = gauss_legendre(order);
  for (std::size_t i = 0; i < nodes.node.size(); ++i) {
    const double angle = from + (to - from) * nodes.node[i];
    nodes.node[i] = horizon * std::sin(angle);
    nodes.weight[i] *= (to - from) * horizon * std::cos(angle);
  }
  return nodes;
}

/// Pairs of plane waves, the entries that they contribute to, and their weights.
struct Sum {
  std::vector<AnglePair> pairs;
  std::vector<std::size_t> entry;
  std::vector<Complex> weight;
};

class Integral {
 public:
  explicit Integral(const Scene& slab)
      : slab_(slab), request_(slab.request), of_lights_(!request_.lights.all(Light::Kind::plane)) {}

  Refined solved(int order, const std::function<Refined(const Scene&)>& solve) const {
    Sum sum;
    for (std::size_t e = 0; e < request_.entries.size(); ++e) add(e, order, sum);
    Scene scene = slab_;
    scene.request = pairs_request(sum.pairs);
    const Refined found = solve(scene);
    const std::size_t entries = request_.entries.size();
    Refined all{std::vector<Complex>(entries), std::vector<Complex>(entries), found.ordinates};
    for (std::size_t i = 0; i < sum.pairs.size(); ++i) {
      all.value[sum.entry[i]] += sum.weight[i] * found.value[i];
      all.error[sum.entry[i]] += sum.weight[i] * found.error[i];
    }
    return all;
  }

 private:
  PlaneWaves waves(Channel channel) const {
    return of_lights_ ? PlaneWaves(request_.lights[channel.light], slab_.k)
                      : PlaneWaves(request_.views[channel.view], slab_.k, slab_.domain.depth);
  }
  double far_angle(Channel channel) const {
    return of_lights_ ? request_.views[channel.view].angle : request_.lights[channel.light].angle;
  }

  void add(std::size_t e, int order, Sum& sum) const {
    const Channel first = request_.channels[request_.entries[e].a],
                  second = request_.channels[request_.entries[e].b];
    const PlaneWaves a = waves(first), b = waves(second);
    const double far_a = far_angle(first), far_b = far_angle(second),
                 difference = std::sin(far_a) - std::sin(far_b);
    const QuadratureRule sines = mean_sines(a, b, difference, order);
    for (std::size_t i = 0; i < sines.node.size(); ++i) {
      const double at_a = a.direction(sines.node[i] + difference / 2),
                   at_b = b.direction(sines.node[i] - difference / 2);
      sum.pairs.push_back(of_lights_ ? AnglePair{at_a, far_a, at_b, far_b}
                                     : AnglePair{far_a, at_a, far_b, at_b});
      sum.entry.push_back(e);
      sum.weight.push_back(2 * pi / slab_.k * sines.weight[i] * a.amplitude(at_a) *
                           std::conj(b.amplitude(at_b)) /
                           std::abs(std::cos(at_a) * std::cos(at_b)));
    }
  }

  const Scene& slab_;
  const CovarianceRequest& request_;
  bool of_lights_;
};

}  // namespace

Refined near_endpoint_covariance(const Scene& slab, const Refinement& refinement,
                                 const std::function<Refined(const Scene&)>& solve) {
  constexpr int first_order = 24, most = 800;
  const Integral integral(slab);
  Refined coarse = integral.solved(first_order, solve);
  for (int order = first_order * 3 / 2;; order = order * 3 / 2) {
    Refined fine = integral.solved(order, solve);
    const auto scale = scales(slab.request.entries, fine.value);
    double worst = 0;
    for (std::size_t e = 0; e < scale.size(); ++e) {
      const Complex change = fine.value[e] - coarse.value[e];
      if (scale[e] > 0) worst = std::max(worst, std::abs(change) / scale[e]);
      fine.error[e] = error_of(slab.request.entries[e], fine.value[e],
                               std::abs(fine.error[e]) + std::abs(change));
    }
    if (worst <= refinement.tolerance / 2 || 2 * order > 3 * most) return fine;
    coarse = std::move(fine);
  }
}

}  // namespace flatspeckle::mc

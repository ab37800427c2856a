#include "mc/distance/hankel_contour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;
constexpr Complex i(0, 1);

/// Returns the transform of the detector's area and of the beam: the power on the detector is the
/// integral of R(q) times this over q.
Complex detector_transform(const DistanceDetector& detector, double source_radius, Complex q) {
  Complex beam = 1;
  if (source_radius > 0) beam = 2.0 * complex_bessel_j1(q * source_radius) / (q * source_radius);
  const double distance = detector.distance, extent = detector.extent;
  if (detector.kind == DistanceDetector::Kind::disk)
    return beam * extent * complex_bessel_j1(q * extent) * hankel_in_quadrant(q * distance)[0];
  const auto within = [&](double radius) { return radius * hankel_in_quadrant(q * radius)[1]; };
  return beam * (within(distance + extent / 2) - within(distance - extent / 2));
}

}  // namespace

std::array<Complex, 2> hankel_in_quadrant(Complex z) {
  // K_n(w) = int_0^inf exp(-w cosh t) cosh(n t) dt at w = -i z, by the trapezoidal rule, whose
  // error decreases exponentially.
  constexpr double step = 0.1, rounding = 42;
  const Complex w = -i * z;
  Complex zero = 0.5 * std::exp(-w), one = zero;
  for (int n = 1; w.real() * std::cosh(n * step) < rounding + w.real(); ++n) {
    const double rise = std::cosh(n * step);
    const Complex value = std::exp(-w * rise);
    zero += value;
    one += rise * value;
  }
  return {2.0 / (pi * i) * step * zero, -2.0 / pi * step * one};
}

Complex complex_bessel_j1(Complex z) {
  // J_1(z) = (1/pi) int_0^pi cos(t - z sin t) dt, a periodic integral.
  const int nodes = 32 + static_cast<int>(2 * std::abs(z));
  Complex sum = 0;
  for (int n = 0; n < nodes; ++n) {
    const double t = pi * (n + 0.5) / nodes;
    sum += std::cos(t - z * std::sin(t));
  }
  return sum / static_cast<double>(nodes);
}

double DistanceDetector::area() const {
  return pi * extent * (kind == Kind::disk ? extent : 2 * distance);
}

HankelContour::HankelContour(std::span<const DistanceDetector> detectors, double source_radius) {
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const DistanceDetector& detector : detectors) {
    nearest = std::min(nearest, detector.nearest() - source_radius);
    farthest = std::max(farthest, detector.distance);
  }
  // The integrand falls by exp(-decays) along the path, which is a ray at 45 degrees. Cubic nodes
  // resolve it near 0, where it varies over the reciprocal of the largest distances.
  constexpr double decays = 34;
  const int nodes = farthest < 25 * nearest ? 80 : 160;
  const double longest = decays * std::numbers::sqrt2 / nearest;
  const Complex ray = std::polar(1.0, pi / 4);
  const QuadratureRule rule = gauss_legendre(nodes);
  weights_.resize(detectors.size());
  for (std::size_t n = 0; n < rule.node.size(); ++n) {
    const double u = rule.node[n];
    frequencies_.push_back(longest * u * u * u * ray);
    const Complex weight = 3 * u * u * longest * rule.weight[n] * ray;
    for (std::size_t d = 0; d < detectors.size(); ++d)
      weights_[d].push_back(weight *
                            detector_transform(detectors[d], source_radius, frequencies_.back()));
  }
}

}  // namespace flatspeckle::mc

#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "grin/media/index/radial_field.h"

namespace flatspeckle::oracles {

using grin::Vec3;

/// n^2 = 2 - r^2 out to r = sqrt 2, where n = 0: the field of Luneburg's ball, continued beyond its
/// rim at r = 1. Every ray is the ellipse x0 cos sigma + v0 sin sigma (conventions, C27).
struct HarmonicProfile {
  double excess(double u) const { return (1 - u) / (1 + std::sqrt(2 - u)); }
  grin::RadialJet jet(double u) const {
    const double n = std::sqrt(2 - u);
    return {excess(u), -1 / (2 * n), -1 / (4 * n * n * n)};
  }
};
using HarmonicBall = grin::RadialField<HarmonicProfile, 3>;

/// A curve of the harmonic ball, x(sigma) = x0 cos sigma + v0 sin sigma, by closed forms (C27).
struct HarmonicCurve {
  Vec3 x0, v0;
  double sigma;

  Vec3 x(double s) const { return x0 * std::cos(s) + v0 * std::sin(s); }
  Vec3 v(double s) const { return v0 * std::cos(s) - x0 * std::sin(s); }
  /// Returns the integral of |v| over sigma, by Simpson's rule.
  double arc_length() const {
    const int intervals = 2000;
    double sum = v(0).norm() + v(sigma).norm();
    for (int i = 1; i < intervals; ++i) sum += (i % 2 ? 4 : 2) * v(sigma * i / intervals).norm();
    return sum * sigma / (3 * intervals);
  }
  /// Returns the integral of n^2 = |v|^2 over sigma.
  double optical_path() const {
    return sigma + (v0.squaredNorm() - x0.squaredNorm()) * std::sin(2 * sigma) / 4 -
           x0.dot(v0) * std::pow(std::sin(sigma), 2);
  }
  double spreading() const {
    return std::abs(v0.squaredNorm() * std::pow(std::sin(sigma), 2) *
                    v0.normalized().dot(v(sigma).normalized()));
  }
  /// Counts the foci up to sigma: a point focus at each multiple of pi counts twice, the line focus
  /// between two of them once.
  int caustics() const {
    const double line = std::atan2(v0.squaredNorm(), v0.dot(x0));
    return 2 * static_cast<int>(sigma / std::numbers::pi) +
           static_cast<int>(std::floor((sigma - line) / std::numbers::pi) + 1);
  }
  /// Returns the largest distance from the centre, sampled at 1001 points of the curve.
  double largest_radius() const {
    double largest = 0;
    for (int i = 0; i <= 1000; ++i) largest = std::max(largest, x(sigma * i / 1000).norm());
    return largest;
  }
};

/// Returns all curves from x0 to xf whose parameter sigma is at most `longest_sigma`, in the ball
/// of radius sqrt 2.
inline std::vector<HarmonicCurve> harmonic_curves(const Vec3& x0, const Vec3& xf,
                                                  double longest_sigma) {
  const double b = x0.dot(xf);
  const double root = b * b - 2 * (x0.squaredNorm() + xf.squaredNorm() - 2);
  std::vector<HarmonicCurve> curves;
  if (root < 0) return curves;
  for (const double c : {(b + std::sqrt(root)) / 2, (b - std::sqrt(root)) / 2}) {
    if (std::abs(c) >= 1) continue;
    const double first = std::acos(c);
    const Vec3 v0 = (xf - x0 * c) / std::sin(first);
    // traversed in the opposite sense, the same ellipse connects the points over the rest of its
    // period
    for (double sigma = 0; sigma < longest_sigma; sigma += 2 * std::numbers::pi) {
      curves.push_back({x0, v0, sigma + first});
      curves.push_back({x0, -v0, sigma + 2 * std::numbers::pi - first});
    }
  }
  std::erase_if(curves, [&](const HarmonicCurve& curve) { return curve.sigma > longest_sigma; });
  return curves;
}

}  // namespace flatspeckle::oracles

#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/numbers/random.h"
#include "grin/render/sensors/pixel_grid.h"

namespace flatspeckle::grin {

/// Rings that serve as pixels: parts of a disk between two radii, or directions between two polar
/// angles. The area within radius r is pi r^2, the solid angle within polar angle t is 2 pi (1 -
/// cos t).
class PixelRings {
 public:
  enum class Of { radius, angle };
  /// Makes rings of equal width. last: outer radius or angle of the last ring.
  PixelRings(Of of, int rings, double last) : of_(of), rings_(rings), last_(last) {}
  /// Makes rings with these outer radii, which increase; the first ring is a disk.
  explicit PixelRings(std::vector<double> radii)
      : of_(Of::radius),
        rings_(static_cast<int>(radii.size())),
        last_(radii.back()),
        radii_(std::move(radii)) {}

  PixelGrid grid() const { return {1, rings_}; }
  double area() const { return within(last_); }
  double area(int ring) const { return within(edge(ring + 1)) - within(edge(ring)); }
  std::vector<double> centres() const {
    std::vector<double> values;
    for (int ring = 0; ring < rings_; ++ring) values.push_back((edge(ring) + edge(ring + 1)) / 2);
    return values;
  }
  std::vector<double> shares() const {
    std::vector<double> values;
    for (int ring = 0; ring < rings_; ++ring) values.push_back(area(ring) / area());
    return values;
  }
  const char* axis() const { return of_ == Of::radius ? "radius" : "angle"; }

  /// Radius or angle of the inner edge of a ring.
  double edge(int ring) const {
    if (radii_.empty()) return last_ * ring / rings_;
    return ring > 0 ? radii_[static_cast<std::size_t>(ring) - 1] : 0;
  }
  /// Returns the ring at a radius or angle, -1 beyond the last.
  int ring_at(double coordinate) const {
    if (!(coordinate <= last_)) return -1;
    if (!radii_.empty())
      return static_cast<int>(std::lower_bound(radii_.begin(), radii_.end(), coordinate) -
                              radii_.begin());
    return std::min(static_cast<int>(coordinate / last_ * rings_), rings_ - 1);
  }
  /// A sampled radius or angle, represented by the area or solid angle within it.
  struct Place {
    double within;
    int ring;
  };
  Place sample(double stratum, RandomStream& random) const {
    const int ring = std::min(static_cast<int>(stratum * rings_), rings_ - 1);
    return {within(edge(ring)) + area(ring) * random.uniform(), ring};
  }
  /// Density with which sample() chooses a point of this ring, per area or solid angle.
  double density(int ring) const { return 1 / (rings_ * area(ring)); }

 private:
  double within(double coordinate) const {
    if (of_ == Of::radius) return std::numbers::pi * coordinate * coordinate;
    const double sine = std::sin(coordinate / 2);
    return 4 * std::numbers::pi * sine * sine;
  }

  Of of_;
  int rings_;
  double last_;
  std::vector<double> radii_ = {};
};

}  // namespace flatspeckle::grin

#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/numbers/random.h"
#include "grin/render/sensors/pixel_grid.h"

namespace flatspeckle::grin {

/// Pixels that are rings: of a disk by radius, or of directions by polar angle. The
/// area within r is pi r^2, the solid angle within t is 2 pi (1 - cos t).
class PixelRings {
 public:
  enum class Of { radius, angle };
  /// Of equal width.
  PixelRings(Of of, int rings, double last) : of_(of), rings_(rings), last_(last) {}
  /// The first is the disk within the first of these radii, which increase.
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

  /// The inner one of a ring.
  double edge(int ring) const {
    if (radii_.empty()) return last_ * ring / rings_;
    return ring > 0 ? radii_[static_cast<std::size_t>(ring) - 1] : 0;
  }
  /// -1 beyond.
  int ring_at(double coordinate) const {
    if (!(coordinate <= last_)) return -1;
    if (!radii_.empty())
      return static_cast<int>(std::lower_bound(radii_.begin(), radii_.end(), coordinate) -
                              radii_.begin());
    return std::min(static_cast<int>(coordinate / last_ * rings_), rings_ - 1);
  }
  /// A place by the area within it, evenly over the ring that `stratum` picks.
  struct Place {
    double within;
    int ring;
  };
  Place sample(double stratum, RandomStream& random) const {
    const int ring = std::min(static_cast<int>(stratum * rings_), rings_ - 1);
    return {within(edge(ring)) + area(ring) * random.uniform(), ring};
  }
  /// Of what `sample` draws, per area.
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

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace flatspeckle::grin {

/// Probability density of the squared sine q of the angle between emitted light and the normal of a
/// Lambertian surface: constant within zones of equal width in the sine. Unaimed, q is uniform.
class Aim {
 public:
  static constexpr std::size_t zones = 16;
  using Shares = std::array<double, zones>;

  /// Returns the width of a zone in q.
  static constexpr double width(std::size_t zone) {
    return (2 * static_cast<double>(zone) + 1) / (zones * zones);
  }
  /// Returns the aim that samples each zone with this probability.
  explicit Aim(const Shares& shares) : shares_(shares) {}
  static Aim at_zone(std::size_t zone) {
    Shares shares{};
    shares[zone] = 1;
    return Aim(shares);
  }

  /// Returns the quantile u of q; u in (0, 1).
  double sample(double u) const {
    std::size_t zone = 0;
    for (; zone + 1 < zones && u >= shares_[zone]; ++zone) u -= shares_[zone];
    const double within = shares_[zone] > 0 ? std::min(u / shares_[zone], 1.0) : 0.5;
    return start(zone) + width(zone) * within;
  }
  /// Returns the density of q, relative to that of unaimed light.
  double density(double q) const {
    std::size_t zone = 0;
    while (zone + 1 < zones && q >= start(zone + 1)) ++zone;
    return shares_[zone] / width(zone);
  }

 private:
  static constexpr double start(std::size_t zone) {
    return static_cast<double>(zone * zone) / (zones * zones);
  }

  Shares shares_;
};

}  // namespace flatspeckle::grin

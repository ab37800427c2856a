#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "core/complex.h"
#include "flatland/domain.h"
#include "flatland/medium.h"
#include "grin/phase_function.h"

namespace flatspeckle::mc {

/// A unit vector together with its angle (C2).
struct Direction {
  double angle;
  Vec2 w;

  explicit Direction(double a) : angle(a), w(direction(a)) {}
  Direction(double a, Vec2 unit) : angle(a), w(unit) {}
  Direction reversed() const { return {angle + std::numbers::pi, -w}; }
};

/// What happens at a scatterer, in the three forms that a plan picks from. amplitude() is A of C14
/// divided by sqrt(sigma_s), so that |amplitude|^2 is the phase function; sample() draws a new
/// direction from it.

struct IsotropicScattering {
  static constexpr grin::Isotropic<2> phase{};

  double density(const Direction&, const Direction&) const { return phase.value; }
  double amplitude(const Direction&, const Direction&) const { return std::sqrt(phase.value); }
  Direction sample(const Direction& from, double u) const {
    return Direction(from.angle + phase.sample(u));
  }
};

struct HenyeyGreensteinScattering {
  grin::HenyeyGreenstein<2> phase;

  double density(const Direction& from, const Direction& to) const {
    const Vec2 step = to.w - from.w;  // 1 - cos = |step|^2 / 2 does not cancel
    return phase.density_at(1 - dot(step, step) / 2);
  }
  double amplitude(const Direction& from, const Direction& to) const {
    return std::sqrt(density(from, to));
  }
  Direction sample(const Direction& from, double u) const {
    return Direction(from.angle + phase.sample(u));
  }
};

/// The complex amplitude of a circular scatterer, tabulated and linear between the nodes.
class TabulatedScattering {
 public:
  TabulatedScattering(const BulkMedium& medium, double k)
      : intervals_(4096 * std::max<std::size_t>(medium.t_matrix.size(), 2)),
        amplitude_(tabulate(medium, k, intervals_)),
        phase_([this](double angle) { return std::norm(at(angle)); }, intervals_) {}

  double density(const Direction& from, const Direction& to) const {
    return phase_.density(to.angle - from.angle);
  }
  Complex amplitude(const Direction& from, const Direction& to) const {
    return at(to.angle - from.angle);
  }
  Direction sample(const Direction& from, double u) const {
    return Direction(from.angle + phase_.sample(u));
  }

 private:
  static std::vector<Complex> tabulate(const BulkMedium& medium, double k, std::size_t intervals) {
    std::vector<Complex> values(intervals + 1);
    const double scale = 1 / std::sqrt(medium.cross_sections.scattering);
    for (std::size_t i = 0; i <= intervals; ++i) {
      const double angle =
          std::numbers::pi * static_cast<double>(i) / static_cast<double>(intervals);
      values[i] = scale * flatspeckle::amplitude(medium.t_matrix, k, angle);
    }
    return values;
  }

  Complex at(double angle) const {
    const double position = std::abs(std::remainder(angle, 2 * std::numbers::pi)) /
                            std::numbers::pi * static_cast<double>(intervals_);
    const std::size_t i = std::min(static_cast<std::size_t>(position), intervals_ - 1);
    const double t = position - static_cast<double>(i);
    return (1 - t) * amplitude_[i] + t * amplitude_[i + 1];
  }

  std::size_t intervals_;
  std::vector<Complex> amplitude_;  ///< at angles 0 .. pi; even in the angle
  grin::TabulatedPhaseFunction phase_;
};

}  // namespace flatspeckle::mc

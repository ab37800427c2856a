#pragma once

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "grin/media/geometry/vec3.h"
#include "grin/media/scattering/scattering_medium.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// What powers are differentiated by: coefficients of a uniform medium that fills the stage.
enum class MediumParameter { mu_s, mu_a, g };

/// In this order, those that a medium has: mu_s where it scatters, mu_a, and g of the phase
/// function of Henyey and Greenstein.
inline std::vector<MediumParameter> parameters_of(const ScatteringMedium& medium) {
  if (!(medium.mu_s > 0)) return {MediumParameter::mu_a};
  if (!std::holds_alternative<HgPhase>(medium.phase.which))
    return {MediumParameter::mu_s, MediumParameter::mu_a};
  return {MediumParameter::mu_s, MediumParameter::mu_a, MediumParameter::g};
}
inline std::string name_of(MediumParameter parameter) {
  static constexpr const char* names[] = {"mu_s", "mu_a", "g"};
  return names[static_cast<int>(parameter)];
}

/// Derivatives of the logarithm of a path's density, mu_s^N exp(-(mu_s + mu_a) s) and the product
/// of the phase function over its N collisions, with s its length. Times what the path brings they
/// have the mean of the power's derivatives, however paths were drawn (score function: Glynn 1990,
/// likelihood ratio gradient estimation for stochastic systems).
class PathScore {
 public:
  void flew(double length) { length_ += length; }
  /// A collision at which the path turns from one direction, a unit vector, to another.
  void turned(const ScatteringMedium& medium, const Vec3& from, const Vec3& to) {
    ++collisions_;
    const auto* phase = std::get_if<HgPhase>(&medium.phase.which);
    if (!phase) return;
    const bool is_forward = phase->g >= 0;
    const double slope = slope_of_log(
        std::abs(phase->g), (is_forward ? Vec3(to - from) : Vec3(to + from)).squaredNorm() / 2);
    by_g_ += is_forward ? slope : -slope;
  }

  double by(MediumParameter parameter, const ScatteringMedium& medium) const {
    if (parameter == MediumParameter::mu_s) return collisions_ / medium.mu_s - length_;
    return parameter == MediumParameter::mu_a ? -length_ : by_g_;
  }
  /// Of what has been added to a pixel.
  void add_to(Film& film, int pixel, double value, const ScatteringMedium& medium) const {
    if (pixel < 0 || value == 0 || !std::isfinite(value)) return;
    int number = 0;
    for (const MediumParameter parameter : parameters_of(medium))
      film.add_derivative(pixel, number++, value * by(parameter, medium));
  }

 private:
  /// Derivative of log((1 - g^2) / (1 + g^2 - 2 g cosine)^(3/2)) by g >= 0. In the peak of g near
  /// 1, 1 - cosine keeps the digits that the cosine loses.
  static double slope_of_log(double g, double one_minus_cosine) {
    const double beside = 1 - g, square = beside * beside + 2 * g * one_minus_cosine;
    return 3 * (beside - one_minus_cosine) / square - 2 * g / (beside * (1 + g));
  }

  double length_ = 0, collisions_ = 0, by_g_ = 0;
};

}  // namespace flatspeckle::grin

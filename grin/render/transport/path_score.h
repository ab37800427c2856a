#pragma once

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "grin/media/geometry/vec3.h"
#include "grin/media/scattering/scattering_medium.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// Parameters by which powers are differentiated: coefficients of a uniform medium that fills the
/// stage.
enum class MediumParameter { mu_s, mu_a, g };

/// Returns the parameters of a medium in this order: mu_s if it scatters, mu_a, and g of a
/// Henyey-Greenstein phase function.
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

/// Derivatives of the logarithm of a path's density. For a path of length s with N collisions the
/// density is mu_s^N exp(-(mu_s + mu_a) s) times the phase function at each collision. The mean of
/// contribution times derivative is the derivative of the power, however paths are sampled (score
/// function: Glynn [glynn1990], likelihood ratio gradient estimation for stochastic systems).
class PathScore {
 public:
  void flew(double length) { length_ += length; }
  /// Adds a collision at which the path turns between two directions, unit vectors.
  void turned(const ScatteringMedium& medium, const Vec3& from, const Vec3& to) {
    ++collisions_;
    const auto* phase = std::get_if<HgPhase>(&medium.phase.which);
    if (!phase) return;
    const bool is_forward = phase->g >= 0;
    const double derivative = derivative_of_log(
        std::abs(phase->g), (is_forward ? Vec3(to - from) : Vec3(to + from)).squaredNorm() / 2);
    by_g_ += is_forward ? derivative : -derivative;
  }

  double by(MediumParameter parameter, const ScatteringMedium& medium) const {
    if (parameter == MediumParameter::mu_s) return collisions_ / medium.mu_s - length_;
    return parameter == MediumParameter::mu_a ? -length_ : by_g_;
  }
  /// Adds the derivatives of a contribution `value` to a pixel.
  void add_to(Film& film, int pixel, double value, const ScatteringMedium& medium) const {
    if (pixel < 0 || value == 0 || !std::isfinite(value)) return;
    int number = 0;
    for (const MediumParameter parameter : parameters_of(medium))
      film.add_derivative(pixel, number++, value * by(parameter, medium));
  }

 private:
  /// Derivative of log((1 - g^2) / (1 + g^2 - 2 g cosine)^(3/2)) with respect to g >= 0. cosine: of
  /// the scattering angle. The function takes 1 - cosine to avoid cancellation in the narrow
  /// forward peak if g is near 1.
  static double derivative_of_log(double g, double one_minus_cosine) {
    const double beside = 1 - g, square = beside * beside + 2 * g * one_minus_cosine;
    return 3 * (beside - one_minus_cosine) / square - 2 * g / (beside * (1 + g));
  }

  double length_ = 0, collisions_ = 0, by_g_ = 0;
};

}  // namespace flatspeckle::grin

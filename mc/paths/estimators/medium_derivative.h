#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/paths/endpoint_factors/scattering.h"

namespace flatspeckle::mc {

/// Derivative of log A with respect to a parameter, as a function of the scattering angle, where A
/// is the scattering amplitude divided by sqrt(sigma_s). The derivative has a closed form for the
/// Henyey-Greenstein function; otherwise it is interpolated linearly in a table.
class AmplitudeDerivative {
 public:
  AmplitudeDerivative() = default;  ///< for a parameter that does not change the amplitude
  /// Makes the derivative with respect to a parameter that changes g. factor: derivative of g with
  /// respect to this parameter.
  static AmplitudeDerivative by_g(const BulkMedium& medium, double factor = 1);
  /// table: values at equally spaced angles from 0 to pi.
  explicit AmplitudeDerivative(std::vector<Complex> table) : table_(std::move(table)) {}

  bool depends() const { return factor_ != 0 || !table_.empty(); }

  Complex operator()(Vec from, Vec to) const {
    const double turn = one_minus_cosine(from, to);
    return table_.empty() ? factor_ / 2 * henyey_greenstein_derivative(g_, turn, dimension_)
                          : at(2 * std::asin(std::sqrt(std::min(1.0, turn / 2))));
  }

 private:
  Complex at(double angle) const {
    const auto last = static_cast<double>(table_.size() - 1);
    const double position = angle / std::numbers::pi * last;
    const auto i = static_cast<std::size_t>(std::min(position, last - 1));
    const double t = position - static_cast<double>(i);
    return (1 - t) * table_[i] + t * table_[i + 1];
  }

  double g_ = 0, factor_ = 0;
  int dimension_ = 2;
  std::vector<Complex> table_;
};

/// Derivatives of log mu_t, of log albedo and of the logarithm of the scattering amplitude with
/// respect to a parameter.
struct MediumDerivative {
  std::string name;
  double log_mu_t = 0, log_albedo = 0;
  AmplitudeDerivative amplitude;
};

/// Largest number of parameters with derivatives in one run.
inline constexpr std::size_t most_derivatives = 8;

/// Throws std::logic_error for a medium that varies or does not scatter, and for more than
/// most_derivatives parameters.
void require_derivatives(const Scene& scene, const std::vector<MediumDerivative>& derivatives);

/// Returns the derivatives with respect to one of the bulk_parameters() of a scene.
MediumDerivative medium_derivative(const Scene& scene, BulkParameter parameter);

/// Returns the derivatives with respect to any parameter that changes only the medium, by
/// fourth-order differences. at(x) returns the scene in which the parameter is larger by x; it is
/// called with x = +-step and +-2 step. Throws InputError if the scenes differ in more than the
/// medium, or, in 3D, if the phase function is not Henyey-Greenstein.
MediumDerivative medium_derivative(const std::string& name, const Scene& scene, double step,
                                   const std::function<Scene(double)>& at);

}  // namespace flatspeckle::mc

#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/paths/endpoint_factors/space_scattering.h"

namespace flatspeckle::mc {

/// d log A by a parameter, A the amplitude over sqrt(sigma_s), of a scattering angle: that of
/// Henyey-Greenstein's function in closed form, others as a table that is linear between its nodes.
class AmplitudeSlope {
 public:
  AmplitudeSlope() = default;  ///< the parameter changes no amplitude
  /// factor: d g by the parameter.
  static AmplitudeSlope by_g(const BulkMedium& medium, double factor = 1);
  /// At angles 0 .. pi in equal intervals.
  explicit AmplitudeSlope(std::vector<Complex> table) : table_(std::move(table)) {}

  bool depends() const { return factor_ != 0 || !table_.empty(); }

  template <typename Direction>
  Complex operator()(const Direction& from, const Direction& to) const {
    const double turn = one_minus_cosine(from, to);
    return table_.empty() ? factor_ / 2 * henyey_greenstein_slope(g_, turn, dimension_)
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

/// What a parameter does to a medium: derivatives by it, all that paths need.
struct MediumSlope {
  std::string name;
  double log_mu_t = 0, log_albedo = 0;
  AmplitudeSlope amplitude;
};

/// Of all that paths are differentiated by at once.
inline constexpr std::size_t most_slopes = 8;

/// Throws std::logic_error for a medium that varies or does not scatter, and for more slopes than
/// paths take.
void require_slopes(const Scene& scene, const std::vector<MediumSlope>& slopes);

/// By what describes a scene's scatterers (bulk_parameters()).
MediumSlope medium_slope(const Scene& scene, BulkParameter parameter);

/// By anything that changes the medium alone, in differences of fourth order. at(x): the scene
/// where the parameter is larger by x; its least steps are `step`. Throws InputError where scenes
/// differ in more than the medium, and in space for phase functions but Henyey-Greenstein's.
MediumSlope medium_slope(const std::string& name, const Scene& scene, double step,
                         const std::function<Scene(double)>& at);

}  // namespace flatspeckle::mc

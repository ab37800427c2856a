#include "grin/media/fields/profile_spline.h"

#include <utility>

namespace flatspeckle::grin {

ProfileSpline::ProfileSpline(std::vector<double> coefficients)
    : coefficients_(std::move(coefficients)) {
  if (coefficients_.size() < 4)
    throw InputError("coefficients of a profile", coefficients_.size(), "must be at least 4");
  for (const double c : coefficients_)
    if (!std::isfinite(c)) throw InputError("coefficient of a profile", c, "must be finite");
}

}  // namespace flatspeckle::grin

#include "grin/media/scattering/phase_function.h"

#include <algorithm>

namespace flatspeckle::grin {

namespace {
using std::numbers::pi;
}

TabulatedPhaseFunction::TabulatedPhaseFunction(const std::function<double(double)>& p,
                                               std::size_t intervals)
    : step_(pi / static_cast<double>(intervals)),
      density_(intervals + 1),
      cumulative_(intervals + 1) {
  for (std::size_t i = 0; i <= intervals; ++i) density_[i] = p(static_cast<double>(i) * step_);
  for (std::size_t i = 0; i < intervals; ++i)
    cumulative_[i + 1] = cumulative_[i] + step_ * (density_[i] + density_[i + 1]);
  const double norm = cumulative_.back();
  for (double& value : density_) value /= norm;
  for (double& value : cumulative_) value /= norm;
}

double TabulatedPhaseFunction::density(double angle) const {
  const double position = std::abs(std::remainder(angle, 2 * pi)) / step_;
  const std::size_t i = std::min(static_cast<std::size_t>(position), density_.size() - 2);
  const double t = position - static_cast<double>(i);
  return (1 - t) * density_[i] + t * density_[i + 1];
}

double TabulatedPhaseFunction::sample(double u) const {
  const double sign = u < 0.5 ? -1 : 1;
  const double target = std::abs(2 * u - 1);
  const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, target);
  const auto i =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - cumulative_.begin() - 1, 0));
  // Within the interval, the integral of twice the density p is step (2 p0 t + (p1 - p0) t^2). This
  // is solved for t in a form without cancellation.
  const double p0 = density_[i], difference = density_[i + 1] - density_[i];
  const double rest = (target - cumulative_[i]) / step_;
  const double root = p0 + std::sqrt(std::max(0.0, p0 * p0 + difference * rest));
  const double t = root > 0 ? std::clamp(rest / root, 0.0, 1.0) : 0.5;
  return sign * (static_cast<double>(i) + t) * step_;
}

}  // namespace flatspeckle::grin

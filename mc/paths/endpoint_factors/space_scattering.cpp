#include "mc/paths/endpoint_factors/space_scattering.h"

#include <numbers>

namespace flatspeckle::mc {

TabulatedSpaceScattering::TabulatedSpaceScattering(const std::vector<Complex>& amplitudes) {
  const auto given = static_cast<double>(amplitudes.size() - 1);
  // No step of the angle is then wider than those of the given amplitudes.
  middle_ = std::ceil(2 / std::numbers::pi * given);
  const auto intervals = 2 * static_cast<std::size_t>(middle_);
  for (std::size_t i = 0; i <= intervals; ++i) {
    const double angle = 2 * std::asin(std::sqrt(half_sine_square(i)));
    const double place = angle / std::numbers::pi * given;
    const auto before = std::min(static_cast<std::size_t>(place), amplitudes.size() - 2);
    const double t = place - static_cast<double>(before);
    amplitude_.push_back((1 - t) * amplitudes[before] + t * amplitudes[before + 1]);
  }
  for (std::size_t i = 0; i < intervals; ++i) {
    // With u = sin(angle / 2), or cos(angle / 2) beyond pi/2, the solid angle is 8 pi u du, and
    // Simpson's rule is exact.
    const auto integrand = [&](double position) {
      return std::min(position, 2 * middle_ - position) * std::norm(at(position));
    };
    const auto low = static_cast<double>(i);
    const double sum = integrand(low) + 4 * integrand(low + 0.5) + integrand(low + 1);
    so_far_.push_back(so_far_.back() + 4 * std::numbers::pi / (middle_ * middle_) * sum / 6);
  }
  const double scale = 1 / std::sqrt(so_far_.back());
  for (Complex& value : amplitude_) value *= scale;
}

double TabulatedSpaceScattering::half_sine_square(std::size_t i) const {
  const double position = static_cast<double>(i) / middle_;
  return position <= 1 ? position * position / 2 : 1 - (2 - position) * (2 - position) / 2;
}

/// Samples an interval of the table, then an angle in this interval by rejection from a uniform
/// distribution over the sphere.
Vec TabulatedSpaceScattering::sample(Vec from, RandomStream& random) const {
  const double target = random.uniform() * so_far_.back();
  const auto above = std::upper_bound(so_far_.begin() + 1, so_far_.end() - 1, target);
  const auto i = static_cast<std::size_t>(above - so_far_.begin()) - 1;
  const double low = half_sine_square(i), high = half_sine_square(i + 1),
               most = std::max(std::norm(amplitude_[i]), std::norm(amplitude_[i + 1]));
  double t, half;
  do {
    t = low + (high - low) * random.uniform();
    half = std::sqrt(2 * std::min(t, 1 - t));
  } while (random.uniform() * most > std::norm(at(middle_ * (t < 0.5 ? half : 2 - half))));
  return turned_in_space(from, 2 * t, random);
}

}  // namespace flatspeckle::mc

#include "grin/render/lights/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

std::size_t pixel_at(double coordinate, std::size_t count) {
  return std::min(static_cast<std::size_t>(coordinate * static_cast<double>(count)), count - 1);
}

}  // namespace

EnvironmentMap::EnvironmentMap(std::size_t rows, std::size_t columns, std::vector<double> radiance,
                               const Vec3& centre, const Vec3& up)
    : rows_(rows),
      columns_(columns),
      radiance_(std::move(radiance)),
      right_(centre.cross(up).normalized()),
      up_(up.normalized()) {
  forward_ = up_.cross(right_);
  power_so_far_.reserve(radiance_.size());
  for (std::size_t i = 0; i < radiance_.size(); ++i) {
    total_ += radiance_[i] * solid_angle(i / columns_);
    power_so_far_.push_back(total_);
  }
}

double EnvironmentMap::solid_angle(std::size_t row) const {
  const double step = pi / static_cast<double>(rows_),
               middle = (static_cast<double>(row) + 0.5) * step;
  return 2 * pi / static_cast<double>(columns_) * 2 * std::sin(middle) * std::sin(step / 2);
}

Vec3 EnvironmentMap::direction(double down, double across) const {
  const double angle = pi * down, azimuth = 2 * pi * (across - 0.5);
  return std::cos(angle) * up_ +
         std::sin(angle) * (std::cos(azimuth) * forward_ + std::sin(azimuth) * right_);
}

double EnvironmentMap::radiance(const Vec3& from) const {
  const double down = std::acos(std::clamp(from.dot(up_), -1.0, 1.0)) / pi;
  const double across = std::atan2(from.dot(right_), from.dot(forward_)) / (2 * pi) + 0.5;
  return radiance_[pixel_at(down, rows_) * columns_ + pixel_at(across, columns_)];
}

Vec3 EnvironmentMap::sample(RandomStream& random) const {
  const auto found = std::ranges::upper_bound(power_so_far_, total_ * random.uniform());
  const auto pixel =
      static_cast<std::size_t>(std::min(found, power_so_far_.end() - 1) - power_so_far_.begin());
  const double row = static_cast<double>(pixel / columns_), rows = static_cast<double>(rows_);
  const double first = std::cos(pi * row / rows), last = std::cos(pi * (row + 1) / rows);
  const double cosine = first + (last - first) * random.uniform();
  const double across =
      (static_cast<double>(pixel % columns_) + random.uniform()) / static_cast<double>(columns_);
  return direction(std::acos(std::clamp(cosine, -1.0, 1.0)) / pi, across);
}

double EnvironmentMap::integral(const std::function<double(const Vec3&)>& weight) const {
  double sum = 0;
  for (std::size_t i = 0; i < radiance_.size(); ++i) {
    const double down = (static_cast<double>(i / columns_) + 0.5) / static_cast<double>(rows_);
    const double across = (static_cast<double>(i % columns_) + 0.5) / static_cast<double>(columns_);
    sum += radiance_[i] * solid_angle(i / columns_) * weight(direction(down, across));
  }
  return sum;
}

}  // namespace flatspeckle::grin

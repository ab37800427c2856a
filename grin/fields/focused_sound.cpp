#include "grin/fields/focused_sound.h"

#include <algorithm>
#include <numbers>

#include "grin/fields/input_checks.h"

namespace flatspeckle::grin {

namespace {
constexpr double pi = std::numbers::pi;
}

FocusedSound::FocusedSound(double background, double amplitude, double k,
                           const std::vector<Vec3>& directions, const Vec3& focus, double psi)
    : background_(background),
      amplitude_(amplitude / static_cast<double>(std::max<std::size_t>(directions.size(), 1))),
      focus_(focus),
      psi_(psi) {
  if (directions.empty()) throw InputError("emitters", 0, "at least one");
  if (!(k > 0 && std::isfinite(k)))
    throw InputError("wavenumber of the sound", k, "must be positive");
  for (const Vec3& direction : directions) {
    if (!(direction.norm() > 0))
      throw InputError("direction of an emitter", listed(direction), "must not be 0");
    waves_.push_back(k * direction.normalized());
  }
}

std::vector<Vec3> arc_directions(int count, double aperture) {
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double angle = aperture * ((2 * i + 1.0) / count - 1);
    directions.emplace_back(std::sin(angle), 0, std::cos(angle));
  }
  return directions;
}

/// A Fibonacci spiral.
std::vector<Vec3> cap_directions(int count, double aperture) {
  const double golden_angle = pi * (3 - std::sqrt(5.0));
  const double half_sine = std::sin(aperture / 2);
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double drop = 2 * half_sine * half_sine * (i + 0.5) / count;  // 1 - cos
    const double radius = std::sqrt(drop * (2 - drop)), azimuth = golden_angle * i;
    directions.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth), 1 - drop);
  }
  return directions;
}

}  // namespace flatspeckle::grin

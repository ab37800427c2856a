#include "grin/media/scattering/start_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grin/media/geometry/frame.h"

namespace flatspeckle::grin {

using std::numbers::pi;

Vec3 StartDirections::sample(const Vec3& chord, RandomStream& random) const {
  const double lowest = random.uniform() < chord_share ? cosine : -1;
  const double c = 1 - (1 - lowest) * random.uniform();
  return direction_about(chord, c, 2 * pi * random.uniform());
}

double StartDirections::density(double cos_from_chord) const {
  const double everywhere = (1 - chord_share) / (4 * pi);
  return cos_from_chord > cosine ? everywhere + chord_share / (2 * pi * (1 - cosine)) : everywhere;
}

Vec3 direction_about(const Vec3& axis, double cosine, double azimuth) {
  const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
  const Frame across = frame_across(axis);
  return cosine * axis +
         sine * (std::cos(azimuth) * across.col(0) + std::sin(azimuth) * across.col(1));
}

}  // namespace flatspeckle::grin

#pragma once

#include <cmath>
#include <numbers>

#include "grin/media/scattering/start_directions.h"
#include "grin/render/endpoints/path_end.h"

namespace flatspeckle::grin {

/// Of light that arrives on a surface within an angle from its outward normal: W of path_end.h is
/// `reading` there and 0 beyond.
class Acceptance {
 public:
  explicit Acceptance(double angle) : sine_squared_(std::sin(angle) * std::sin(angle)) {}

  /// Infinite for all directions.
  double tangent() const { return std::sqrt(sine_squared_ / (1 - sine_squared_)); }

  EndDirection sample(const EndPosition& at, double reading, RandomStream& random) const {
    const double squared = sine_squared_ * random.uniform();
    return towards(at, random_turn(at.inward, squared / (1 + std::sqrt(1 - squared)), random),
                   reading);
  }
  EndDirection towards(const EndPosition& at, const Vec3& direction, double reading) const {
    EndDirection to{.direction = direction};
    const double cosine = direction.dot(at.inward);
    if (!(cosine > 0 && 1 - cosine * cosine <= sine_squared_)) return to;
    to.density = cosine / (std::numbers::pi * sine_squared_);
    to.pixel = at.pixel;
    to.strength = at.index * at.index * cosine * reading;
    return to;
  }

 private:
  double sine_squared_;
};

}  // namespace flatspeckle::grin

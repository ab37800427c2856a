#pragma once

#include <cmath>

#include "flatland/media/domain.h"

namespace flatspeckle::mc {

/// The part of a domain's outline that a plane wave along `light` enters through: a face and, of a
/// box, a side.
class LightAperture {
 public:
  LightAperture(const Domain& domain, Vec2 light)
      : domain_(domain),
        light_(light),
        is_slab_(domain.kind == Domain::Kind::slab),
        face_(is_slab_ ? std::abs(light.z) : domain.width * std::abs(light.z)),
        side_(is_slab_ ? 0 : domain.depth * std::abs(light.x)) {}

  // Widths across the light; of a slab per unit length.
  double face() const { return face_; }
  double side() const { return side_; }

  /// The point at a share of the way across; of a slab one stands for all.
  Vec2 at(double share) const {
    const double z = light_.z > 0 ? 0 : domain_.depth;
    if (is_slab_) return {0, z};
    const double across = share * (face_ + side_);
    if (across < face_) return {across / std::abs(light_.z) - domain_.width / 2, z};
    return {std::copysign(domain_.width / 2, -light_.x), (across - face_) / std::abs(light_.x)};
  }

 private:
  Domain domain_;
  Vec2 light_;
  bool is_slab_;
  double face_, side_;
};

}  // namespace flatspeckle::mc

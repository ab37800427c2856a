#pragma once

#include <cmath>

#include "core/numbers/random.h"
#include "flatland/media/domain.h"

namespace flatspeckle::mc {

/// The part of a domain's outline through which a plane wave along `light` enters: a face and, for
/// a box, a side; in space, a face and two sides.
class LightAperture {
 public:
  LightAperture(const Domain& domain, Vec light)
      : domain_(domain), light_(light), is_slab_(domain.kind == Domain::Kind::slab) {
    face_ = is_slab_ ? std::abs(light.z) : domain.width * std::abs(light.z);
    side_ = is_slab_ ? 0 : domain.depth * std::abs(light.x);
    if (is_slab_ || domain.height == 0) return;
    face_ *= domain.height;
    side_ *= domain.height;
    other_side_ = domain.width * domain.depth * std::abs(light.y);
  }

  Vec light() const { return light_; }
  // Projected widths or, in space, areas, perpendicular to the light: of the face, of the side
  // perpendicular to x and, in space, of the side perpendicular to y; for a slab, per unit length
  // or area of the face.
  double face() const { return face_; }
  double side() const { return side_; }
  double other_side() const { return other_side_; }
  double all() const { return face_ + side_ + other_side_; }

  /// Samples the entry point, uniformly over the cross-section of the light. In a slab one point
  /// represents all.
  Vec sample(RandomStream& random) const {
    if (is_slab_) return at(0, 0, 0);
    const double share = random.uniform();
    if (domain_.height == 0) return at(share, 0, 0);
    const double first = random.uniform();
    return at(share, first, random.uniform());
  }

  /// Returns the entry point at a fraction `share` of the cross-section, in the order of face and
  /// sides. In space, first and second are the fractions of the extents of the face or side.
  Vec at(double share, double first, double second) const {
    const double z = light_.z > 0 ? 0 : domain_.depth, across = share * all();
    if (is_slab_) return {0, z};
    if (domain_.height > 0) {
      const double x = (first - 0.5) * domain_.width, y = (second - 0.5) * domain_.height;
      if (across < face_) return {x, z, y};
      if (across < face_ + side_)
        return {std::copysign(domain_.width / 2, -light_.x), first * domain_.depth, y};
      return {x, second * domain_.depth, std::copysign(domain_.height / 2, -light_.y)};
    }
    if (across < face_) return {across / std::abs(light_.z) - domain_.width / 2, z};
    return {std::copysign(domain_.width / 2, -light_.x), (across - face_) / std::abs(light_.x)};
  }

 private:
  Domain domain_;
  Vec light_;
  bool is_slab_;
  double face_ = 0, side_ = 0, other_side_ = 0;
};

}  // namespace flatspeckle::mc

#pragma once

#include <compare>
#include <initializer_list>
#include <vector>

#include "flatland/media/domain.h"

namespace flatspeckle {

/// Illumination of the medium, with unit amplitude: a plane wave exp(i k w.r), a point source (the
/// Green function of C3), or a Gaussian beam whose field is 1 at its focus.
struct Light {
  enum class Kind { plane, point, beam };
  Kind kind = Kind::plane;
  double angle = 0;    ///< direction of a plane wave or of a beam's axis, from +z (C2)
  Vec point;           ///< position of a point source, or of a beam's focus
  double waist = 0;    ///< 1/e radius of a beam's field at its focus
  double azimuth = 0;  ///< rotation of the direction about z, from x towards y (C55)

  Vec direction() const { return flatspeckle::direction(angle, azimuth); }
  auto operator<=>(const Light&) const = default;
};

inline Light plane_wave(double angle, double azimuth = 0) {
  return {Light::Kind::plane, angle, {}, 0, azimuth};
}
inline Light point_source(Vec point) {
  return {Light::Kind::point, 0, point, 0};
}
inline Light gaussian_beam(double angle, Vec focus, double waist, double azimuth = 0) {
  return {Light::Kind::beam, angle, focus, waist, azimuth};
}

/// List of illuminations. A list of numbers is converted to plane waves with these angles (C2).
struct Lights : std::vector<Light> {
  Lights() = default;
  Lights(std::vector<Light> lights) : std::vector<Light>(std::move(lights)) {}
  Lights(std::initializer_list<Light> lights) : std::vector<Light>(lights) {}
  Lights(std::initializer_list<double> angles) : Lights(std::vector<double>(angles)) {}
  Lights(const std::vector<double>& angles) {
    for (double angle : angles) push_back(plane_wave(angle));
  }

  std::vector<double> angles() const {
    std::vector<double> list;
    for (const Light& light : *this) list.push_back(light.angle);
    return list;
  }
  bool all(Light::Kind kind) const {
    for (const Light& light : *this)
      if (light.kind != kind) return false;
    return true;
  }
};

}  // namespace flatspeckle

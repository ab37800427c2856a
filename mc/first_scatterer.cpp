#include "mc/first_scatterer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle::mc {

namespace {

/// Whether paths started for one light serve the other: plane waves and beams by direction, beams
/// and sources by position.
bool alike(const Light& a, const Light& b, double spacing, double wavelength) {
  if (a.kind != b.kind) return false;
  if (a.kind == Light::Kind::point) return length(a.point - b.point) <= wavelength / 2;
  const double turn = std::abs(std::remainder(a.angle - b.angle, 2 * std::numbers::pi));
  if (a.kind == Light::Kind::plane) return turn <= spacing;
  const double divergence = wavelength / (std::numbers::pi * b.waist);
  return turn <= std::min(spacing, divergence / 2) && a.waist == b.waist &&
         length(a.point - b.point) <= b.waist / 2;
}

}  // namespace

Lights representative_lights(const Scene& scene) {
  const double spacing = std::max(0.5 * (1 - std::abs(scene.medium.g)), 0.01);
  Lights chosen;
  for (const Light& light : scene.request.lights) {
    const bool known = std::any_of(chosen.begin(), chosen.end(), [&](const Light& other) {
      return alike(light, other, spacing, scene.wavelength);
    });
    if (!known) chosen.push_back(light);
  }
  return chosen;
}

FirstScatterer::FirstScatterer(const Scene& scene)
    : domain_(scene.domain), mu_t_(scene.medium.mu_t) {
  for (const Light& light : representative_lights(scene)) {
    switch (light.kind) {
      case Light::Kind::plane:
        plane_.push_back(direction(light.angle));
        break;
      case Light::Kind::point:
        point_.emplace_back(domain_, mu_t_, light.point);
        break;
      case Light::Kind::beam:
        for (const auto& rays : beam_rays(domain_, mu_t_, GaussianBeam(light, scene.k)))
          beam_.push_back(rays);
        break;
    }
  }
  count_ = static_cast<double>(plane_.size() + point_.size() + beam_.size());
}

}  // namespace flatspeckle::mc

#include "mc/paths/walk/first_scatterer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mc/paths/walk/representatives.h"

namespace flatspeckle::mc {

namespace {

/// Whether paths started for one source or beam serve the other.
bool alike(const Light& a, const Light& b, double spacing, double wavelength) {
  if (a.kind != b.kind) return false;
  if (a.kind == Light::Kind::point) return length(a.point - b.point) <= wavelength / 2;
  const double turn = std::abs(std::remainder(a.angle - b.angle, 2 * std::numbers::pi));
  const double divergence = wavelength / (std::numbers::pi * b.waist);
  return turn <= std::min(spacing, divergence / 2) && a.waist == b.waist &&
         length(a.point - b.point) <= b.waist / 2;
}

}  // namespace

Lights representative_lights(const Scene& scene) {
  const double spacing = std::max(0.5 * (1 - std::abs(scene.medium.g)), 0.01);
  // After the first, which tilted ones are seen against, oblique ones: they reach deep along the
  // sides, where others have no density.
  std::vector<Light> lights(scene.request.lights.begin(), scene.request.lights.end());
  std::stable_sort(lights.begin() + 1, lights.end(), [](const Light& a, const Light& b) {
    return std::abs(std::sin(a.angle)) > std::abs(std::sin(b.angle));
  });
  Lights chosen;
  std::vector<Vec2> waves;  // of the chosen, where they are plane
  for (const Light& light : lights) {
    const bool plane = light.kind == Light::Kind::plane;
    const bool known = plane ? reached(scene, direction(light.angle), waves, spacing)
                             : std::any_of(chosen.begin(), chosen.end(), [&](const Light& other) {
                                 return alike(light, other, spacing, scene.wavelength);
                               });
    if (known) continue;
    chosen.push_back(light);
    if (plane) waves.push_back(direction(light.angle));
  }
  return chosen;
}

FirstScatterer::FirstScatterer(const Scene& scene, double rise)
    : domain_(scene.domain),
      profile_(scene.profile.get()),
      mu_t_(scene.medium.mu_t),
      pull_(rise / scene.medium.mu_t) {
  const Extinction extinction(scene);
  for (const Light& light : representative_lights(scene)) {
    switch (light.kind) {
      case Light::Kind::plane:
        plane_.push_back(direction(light.angle));
        break;
      case Light::Kind::point:
        point_.emplace_back(domain_, extinction, light.point);
        break;
      case Light::Kind::beam:
        for (const auto& rays : beam_rays(domain_, extinction, GaussianBeam(light, scene.k)))
          beam_.push_back(rays);
        break;
    }
  }
  count_ = static_cast<double>(plane_.size() + point_.size() + beam_.size());
}

}  // namespace flatspeckle::mc

#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Whether a far view lies in the forward lobe of a plane wave or beam that crosses a box
/// undeflected, or in that of the specular reflection if the faces reflect. The lobe is the central
/// diffraction lobe of an aperture as wide (and, in space, as high) as the box; it contains the
/// coherent field.
inline bool in_forward_lobe(const Scene& scene, const Channel& channel) {
  const View& view = scene.request.views[channel.view];
  const Light& light = scene.request.lights[channel.light];
  if (scene.domain.kind != Domain::Kind::box || view.near || light.kind == Light::Kind::point ||
      (std::cos(view.angle) <= 0 && !scene.faces))
    return false;
  const Vec q = scene.outside_k() * (view.direction() - light.direction());
  return std::abs(q.x) < 2 * std::numbers::pi / scene.domain.width &&
         std::abs(q.y) * scene.domain.height <= 2 * std::numbers::pi;
}

/// Whether all placements of scatterers in a box have the same number of them: always for disks,
/// whose number is rounded, and for points if `count` is set.
inline bool has_fixed_number(const Scene& scene) {
  return scene.domain.kind == Domain::Kind::box &&
         (scene.scatterer.is_disk() || scene.placement.count);
}

/// Whether the exact covariance of an entry lacks a term that Monte Carlo includes: the fluctuation
/// of the coherent field with the number of scatterers (conventions, C12). The entry lacks this
/// term if that number is fixed and both channels lie in the forward lobe.
inline bool lacks_fluctuation(const Scene& scene, const Entry& entry) {
  const auto& channels = scene.request.channels;
  return has_fixed_number(scene) && in_forward_lobe(scene, channels[entry.a]) &&
         in_forward_lobe(scene, channels[entry.b]);
}

/// Returns the smallest n^2 in the domain if n^2 is a quadratic function, otherwise 1. The mean
/// free path and the local wavenumber are both proportional to n (C31), so their product is
/// smallest where n^2 is smallest.
inline double least_square(const Scene& scene) {
  if (!scene.index || !scene.index->is_quadratic()) return 1;
  const double half = scene.domain.width / 2;
  double least = scene.index->square({half, 0});
  for (const Vec corner : {Vec{-half, 0}, {half, scene.domain.depth}, {-half, scene.domain.depth}})
    least = std::min(least, scene.index->square(corner));
  return least;
}

/// Returns the relative size of the interference, in a medium with faces, between the waves of one
/// plane wave that the faces reflect. angle: direction outside. One part is between waves along the
/// same direction, before and after a round trip. It depends on the depth in wavelengths. The other
/// part is between the downgoing and the upgoing wave, averaged over the depth (C46).
inline double face_interference(const Scene& scene, double angle) {
  const double cosine = scene.faces->entering().refracted(std::abs(std::cos(angle)));
  if (cosine == 0) return 1;
  const double reflected = std::abs(scene.faces->leaving().reflected(cosine)),
               depth = scene.domain.depth,
               round_trip = std::exp(-scene.medium.mu_t * depth / cosine);
  return 2 * reflected * (reflected * round_trip + 1 / (scene.k * depth * cosine));
}

/// Returns the largest face_interference() of a light plus that of a view; 0 without faces.
inline double face_interference(const Scene& scene) {
  double lights = 0, views = 0;
  if (!scene.faces) return 0;
  for (const Light& light : scene.request.lights)
    lights = std::max(lights, face_interference(scene, light.angle));
  for (const View& view : scene.request.views)
    views = std::max(views, face_interference(scene, view.angle));
  return lights + views;
}

/// Estimated relative size of the effects that the Monte Carlo method neglects; not a bound.
/// Deviations from exact solutions were measured in data/bias_map.csv.
struct Allowance {
  /// crossed_paths: corrections of order 1/(k mean free path).
  ///
  /// k_shift: effects of the shift of the wavenumber in the medium: refraction at the faces, and
  /// local fields.
  ///
  /// guided: guiding of the mean field in a box by its effective index, which shifts the phase.
  /// This effect grows with the distance that a ray at the critical angle sqrt(2 |k_shift| / k)
  /// moves across the box over its depth, relative to the width (measured for widths from 3 to 20
  /// wavelengths).
  ///
  /// correlations: correlations of the positions of the scatterers. Their effect is of the order of
  /// the packing fraction if they are not modelled, and of the order of its square if they are
  /// (C16). In space it reaches 8 times the packing fraction near the forward direction, where the
  /// structure factor of hard spheres is 1 - 8 packing, and 4 times its square if they are
  /// modelled.
  ///
  /// fixed_number: effect in space of a fixed number N of scatterers outside the forward lobe. Each
  /// scatterer is surrounded by N - 1 others, which changes each order of scattering by about 1/N.
  ///
  /// faces: interference between waves that reflecting faces return (face_interference()).
  double crossed_paths, k_shift, guided, correlations, faces, fixed_number;
  /// Fraction of free flights shorter than k a^2, where a is the radius of the disks. It is (k a)^2
  /// / (k mean free path). At such distances the far field of a disk does not hold. bias_map.csv
  /// was measured at k a = 1, so crossed_paths includes the value at k a = 1, which is subtracted
  /// here. near_zone is not included in total().
  double near_zone;

  explicit Allowance(const Scene& scene)
      : crossed_paths(2 / (scene.k * scene.medium.mean_free_path() * least_square(scene))),
        faces(face_interference(scene)),
        fixed_number(scene.medium.dimension == 3 && has_fixed_number(scene)
                         ? 1 / std::max(1.0, scene.placement.mean_count)
                         : 0) {
    const double shift = std::abs(scene.medium.k_shift) / scene.k, depth = scene.domain.depth,
                 phase = std::min(1.0, scene.k * shift * depth),
                 across = std::min(1.0, std::sqrt(2 * shift) * depth / scene.domain.width);
    k_shift = 2 * shift;
    const bool refracted = scene.index && !scene.index->is_around(),
               guides = scene.domain.kind == Domain::Kind::box && !refracted;
    guided = guides ? 0.35 * phase * across : 0;
    const bool space = scene.medium.dimension == 3;
    const double packing = scene.medium.packing_fraction;
    correlations = scene.medium.structure.independent() ? (space ? 8 : 1) * packing
                                                        : (space ? 4 : 1) * packing * packing;
    const double size = scene.scatterer.is_disk() ? scene.k * scene.scatterer.radius : 0;
    near_zone = std::max(0.0, size * size - 1) / (scene.k * scene.medium.mean_free_path());
  }
  double total() const {
    return crossed_paths + k_shift + guided + correlations + faces + fixed_number;
  }
};

}  // namespace flatspeckle::mc

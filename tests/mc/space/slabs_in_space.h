#pragma once

#include <cmath>
#include <numbers>

#include "grin/media/scattering/phase_function.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::mc::tests {

using SpaceSlab = SlabOf<SpaceGeometry, double>;
using SpaceRequest = RequestOf<Eigen::Vector3d>;

/// Returns a slab of Henyey-Greenstein scatterers; the wavelength is 1.
inline SpaceSlab hg_space(double depth, double optical_depth, double g, double albedo) {
  const double mu_t = optical_depth / depth;
  const SpaceLaw law(
      [g](double cosine) { return grin::HenyeyGreenstein<3>{g}.density_at(cosine); });
  const double k = 2 * std::numbers::pi;
  return {k, mu_t, depth, {{mu_t, depth, albedo, law, k}}};
}

/// Returns the unit vector into the slab with these components along it.
inline Eigen::Vector3d downward(double x, double y) {
  return {x, y, std::sqrt(1 - x * x - y * y)};
}

/// Returns the unit vector at an angle to z and an azimuth.
inline Eigen::Vector3d spherical(double angle, double azimuth) {
  return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
          std::cos(angle)};
}

/// Requests, for channels (light, view), the covariance of each with the first, then all
/// intensities.
inline SpaceRequest against_first(const std::vector<Eigen::Vector3d>& lights,
                                  const std::vector<Eigen::Vector3d>& views) {
  SpaceRequest request{lights, views, {}, {}};
  for (std::uint32_t i = 0; i < lights.size(); ++i) request.channels.push_back({i, i});
  for (std::uint32_t i = 1; i < lights.size(); ++i) request.entries.push_back({0, i});
  for (std::uint32_t i = 0; i < lights.size(); ++i) request.entries.push_back({i, i});
  return request;
}

}  // namespace flatspeckle::mc::tests

#pragma once

#include <numbers>

#include "flatland/scene/scene.h"

namespace flatspeckle::bench {

/// The wavenumber of a wavelength of 1.
inline constexpr double k = 2 * std::numbers::pi;

/// A cylinder of this size parameter at a wavelength of 1.
Scatterer disk(Scatterer::Kind kind, double ka, Complex index = 1.5);

// Standard scenes (data/scenes) as memory effect over 64 tilts that reach beyond its range, in
// transmission.

/// Views 0.1 and 0.8.
Scene box_points();
/// At optical depth 10, along the normal.
Scene slab_hg(double g);

}  // namespace flatspeckle::bench

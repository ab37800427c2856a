#pragma once

#include <numbers>

#include "flatland/scene/scene.h"

namespace flatspeckle::bench {

/// Wavenumber at wavelength 1.
inline constexpr double k = 2 * std::numbers::pi;

/// A cylinder of size parameter ka at wavelength 1.
Scatterer disk(Scatterer::Kind kind, double ka, Complex index = 1.5);

// Standard scenes (data/scenes): memory effect in transmission, over 64 tilts that extend beyond
// its range.

/// Returns the box with detection directions at 0.1 and 0.8 rad.
Scene box_points();
/// Returns the slab with optical depth 10, detected along the normal.
Scene slab_hg(double g);

}  // namespace flatspeckle::bench

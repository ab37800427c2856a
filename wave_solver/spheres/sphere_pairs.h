#pragma once

#include "wave_solver/equations/basis_orders.h"

namespace flatspeckle::wave {

/// Largest degree of the waves of a sphere.
inline constexpr int highest_degree = 40;

/// Returns the rules by which BasisOrders chooses the orders of spheres. Pairs of spheres are
/// solved for the waves that depend on the azimuth about their axis as 1 or cos(phi), lit along the
/// axis or from the side. Waves of higher orders m decay faster from sphere to sphere. The
/// coefficients are divided by sqrt(4 pi), so that a plane wave along the axis excites sqrt((2 l +
/// 1) |T_l|).
OrderRules sphere_rules();

}  // namespace flatspeckle::wave

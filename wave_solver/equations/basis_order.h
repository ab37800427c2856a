#pragma once

#include <span>
#include <vector>

#include "core/numbers/scaled.h"
#include "flatland/placement/placement.h"

namespace flatspeckle::wave {

/// T_n of every scatterer for n = 0 .. its basis order.
///
/// The order is the one at which the pairs that a disk forms with the closest neighbours of every
/// kind (neighbours.h), each solved by itself, have converged: with beta_n its
/// coefficients under plane waves and F the root mean square of its amplitude sum T_n e^{in theta},
///   sum beta_n^2 + sum beta_n |T_n|^(1/2) |H_n(k r)| <= tolerance F / safety
/// over the orders left out; r is the distance of the nearest near-field sensor. A sensor on the
/// rim of a penetrable disk asks for the field inside too, sum beta_n |u_n| <= tolerance / safety
/// with the rim's u_n (rim_waves.h): what drives a disk from close by falls off half as fast as its
/// far field. Where that takes too many orders (nearly touching hard disks, whose images of each
/// other all add up), beta_n^2 is bounded by F |T_n| w_n^2: |H_n(k s)| is due to those images,
/// which accumulate at the distance s (nearest_image), and gives M >= ln(1/eps) / (2 xi) in
/// statics; between large disks |T_m H_{n+m}(k d)| max(1, |H_m(k s')|) of the neighbour's orders m
/// is more.
///
/// Throws InputError for scatterers without a T-matrix, and, naming the order that would be needed,
/// where it is above highest_order.
std::vector<std::vector<ScaledComplex>> basis(const Placement& placement, double k,
                                              double tolerance, std::span<const Vec2> sensors);

/// Two disks of this order have 16,000 unknowns, a matrix of 4 GB.
inline constexpr int highest_order = 4000;

}  // namespace flatspeckle::wave

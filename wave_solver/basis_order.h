#pragma once

#include <span>
#include <vector>

#include "core/complex.h"
#include "flatland/placement.h"

namespace flatspeckle::wave {

/// T_n of every scatterer for n = 0 .. its basis order: the order beyond which
///   |T_n| max(1/T_max, w_n) max(1, w_n, |H_n(k r)|) <= tolerance / safety.
/// w_n bounds the wave of order n that the nearest neighbour sends to the scatterer and, by
/// reciprocity, what the neighbour feels of it; r is the distance of the nearest near-field sensor.
/// In w_n, |H_n(k s)| is due to the images that two close disks form of each other, which
/// accumulate at the distance s (nearest_image); it alone gives M >= ln(1/eps) / (2 xi) in statics.
/// Between large disks |T_m H_{n+m}(k d)| max(1, |H_m(k s')|) of the neighbour's orders m, at the
/// distance d, is more. Throws InputError for scatterers without a T-matrix, and where disks are so
/// close that T_n leaves extended range before it is negligible.
std::vector<std::vector<ExtendedComplex>> basis(const Placement& placement, double k,
                                                double tolerance, std::span<const Vec2> sensors);

/// Distance from the centre of disk a at which its images in disk b accumulate, reflected outwards:
/// a exp(xi), sinh xi = c/a in bipolar coordinates of focal distance c.
double nearest_image(double radius_a, double radius_b, double distance);

}  // namespace flatspeckle::wave

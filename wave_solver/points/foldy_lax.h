#pragma once

#include <functional>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"

namespace flatspeckle::wave {

/// Wave that a point emits, -4 i G(p, q) with the Green function G of the medium (conventions, C34,
/// C51). For p = q, the part of it that returns to the point.
using EmittedWave = std::function<Complex(Vec p, Vec q)>;

/// Returns the scattered fields of point scatterers, [light][view], by the Foldy-Lax equations
/// (C10, C34). k: wavenumber of the T-matrix. lights: incident field at each scatterer,
/// [light][scatterer]. views: field in a view of a unit wave from each scatterer,
/// [view][scatterer]. Throws std::runtime_error if no finite solution is found.
std::vector<Complex> foldy_lax(const Placement& placement, double k, const EmittedWave& wave,
                               const std::vector<Complex>& lights,
                               const std::vector<Complex>& views);

}  // namespace flatspeckle::wave

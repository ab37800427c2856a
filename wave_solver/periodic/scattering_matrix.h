#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "core/result/invariant.h"
#include "flatland/placement/placement.h"
#include "wave_solver/periodic/periodic_cell.h"
#include "wave_solver/solutions/equation_solver.h"

namespace flatspeckle::wave {

/// Scattering matrix of a periodic cell between its propagating channels, each with unit power
/// flux. Light from the front (travelling towards +z) comes first, then light from the back, each
/// in the order of the channels. Outgoing waves at the front (travelling towards -z) come first,
/// then those at the back. The phase origin of all waves is r = 0.
struct ScatteringMatrix {
  std::vector<CellChannel> channels;
  std::vector<Complex> s;        ///< [light][outgoing]
  std::vector<double> absorbed;  ///< absorbed part of the power: [light]
  /// Relative residual of the equations; -1 if only waves outside of the slab were solved for.
  double residual = -1;
  std::size_t unknowns = 0;
  std::string method;
  /// Largest deviation of outgoing plus absorbed power from 1 and, if nothing is absorbed, of S^H S
  /// from 1.
  Invariant power = {};
  /// Largest deviation of S from its transpose, with k_x reversed. Requires a phase of 0 or pi.
  Invariant reciprocity = {};
  /// Largest change of S if the unit cell begins at another x; see compare_unit_cells().
  Invariant unit_cell = {};

  std::size_t size() const { return 2 * channels.size(); }
  /// Returns a quarter of S as a column-major matrix with a column for each light. back_light: of
  /// the light on the back; back: outgoing waves at the back. The transmission matrix t is
  /// quarter(false, true), the reflection matrix r is quarter(false, false).
  std::vector<Complex> quarter(bool back_light, bool back) const;
};

/// Moves all positions by multiples of the period into one cell, which begins `start` periods above
/// the lowest of them.
Placement in_one_cell(Placement placement, double width, double start = 0);
/// Returns a rectangle that contains all scatterers, rims included.
Rectangle region_of(const Placement& placement);
/// Returns the method of the options, or the one that `automatic` selects.
Method cell_method(std::size_t unknowns, const SolveOptions& options);

/// Solves for all channels. The scatterers are moved by multiples of the period into one cell.
/// Throws InputError if there is no propagating channel, and under the conditions of PeriodicCell
/// and EquationSolver.
ScatteringMatrix scattering_matrix(const Placement& placement, double k, const Period& period,
                                   const SolveOptions& options);
/// Solves a placement in the region of the images.
ScatteringMatrix scattering_matrix_in_region(const Placement& placement, double k,
                                             const CellImages& images, const SolveOptions& options);

/// Estimates the error of S if no residual was computed: solves again for a unit cell that begins
/// at another x, which changes boxes, skeletons, near copies and image waves, but not the exact S.
/// Sets `found.unit_cell`. Doubles the computing time, and is therefore omitted for large cells,
/// which `found.method` reports. Errors due to basis orders are common to both solutions.
void compare_unit_cells(ScatteringMatrix& found, const Placement& placement, double k,
                        const Period& period, const SolveOptions& options);

/// Returns the accuracy of CellImages that a tolerance of the solution requires.
inline double image_tolerance(double tolerance) {
  return std::max(tolerance / 10, 1e-13);
}

}  // namespace flatspeckle::wave

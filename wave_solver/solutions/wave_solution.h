#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/request/request.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/solutions/equation_solver.h"

namespace flatspeckle::wave {

/// The exact scattered field of one placement under unit plane waves. Light and view angles are in
/// radians (C2), positions in the placement's unit of length.
class WaveSolution {
 public:
  /// coefficients: beta of TMatrixSystem, [light][unknown].
  WaveSolution(TMatrixSystem system, std::vector<double> light_angles,
               std::vector<Complex> coefficients);

  const TMatrixSystem& system() const { return system_; }
  const std::vector<double>& light_angles() const { return light_angles_; }
  std::vector<int> basis_order() const;
  const Diagnosis& diagnosis() const { return diagnosis_; }
  /// Description of the method that solved the equations.
  const std::string& method() const { return method_; }
  /// Coefficients beta for a light: [unknown].
  std::span<const Complex> coefficients(std::size_t light) const;

  /// Far-field amplitude A of the whole placement (C4), phase origin r = 0.
  Complex far_field(double view_angle, std::size_t light = 0) const;
  /// Scattered field, without the incident field. Throws InputError for a point inside a scatterer.
  Complex near_field(Vec point, std::size_t light = 0) const;
  /// Far or near fields for all lights: [light][view].
  std::vector<Complex> fields(std::span<const View> views) const;
  /// Far or near fields for one light: [view].
  std::vector<Complex> fields(std::span<const View> views, std::size_t light) const;

 private:
  std::vector<Complex> fields(std::span<const View> views, std::size_t first_light,
                              std::size_t lights) const;
  friend WaveSolution solve(const Placement&, double, const std::vector<double>&,
                            const SolveOptions&);

  TMatrixSystem system_;
  std::vector<double> light_angles_;
  std::vector<Complex> coefficients_;
  std::string method_;
  Diagnosis diagnosis_;
};

/// Solves the multiple scattering of a placement. Throws InputError for overlapping scatterers,
/// disks too close to resolve, or too little memory; std::runtime_error if no finite solution is
/// found.
WaveSolution solve(const Placement& placement, double k, const std::vector<double>& light_angles,
                   const SolveOptions& options = {});

extern const DatasetTable solution_table;
/// Writes the fields in the directions view_angles and at the points `sensors` (either list may be
/// empty) with their axes, the placement, and the diagnosis.
void write_solution(ResultFile& file, const WaveSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec>& sensors);

/// Writes the positions and radii of the scatterers.
void write_placement(ResultFile& file, const Placement& placement);

/// Lights and views of an ensemble of placements within a circle, with a LightBasis of the lights
/// and one of the far views, computed once for all placements.
struct FieldPlan {
  LightBasis lights, far_views;
  std::vector<View> views;
};
FieldPlan make_field_plan(const Lights& lights, std::vector<View> views, double k,
                          const Circle& circle, double tolerance);

/// Returns the fields of a placement, [light][view], without diagnosis. The equations are solved
/// for the lights or, by reciprocity, for the views, whichever are fewer.
std::vector<Complex> scattered_fields(const Placement& placement, double k, const FieldPlan& plan,
                                      const SolveOptions& options);

/// Fields [wavelength][light][view] of one placement at several wavelengths, which are added one
/// after the other, and the diagnosis of each solution.
class Spectrum {
 public:
  Spectrum(const std::vector<double>& view_angles, const std::vector<Vec>& sensors);

  void add(double wavelength, const WaveSolution& solution);

  /// Writes all fields with their axes, the diagnosis of each solution, and the placement.
  void write(ResultFile& file) const;

  /// Largest residual so far.
  double residual() const;
  /// Number of unknowns of the largest system so far.
  std::size_t unknowns() const;

 private:
  std::vector<View> far_views_, near_sensors_;
  std::vector<double> wavelengths_, light_angles_;
  std::vector<Complex> far_, near_;
  std::vector<std::uint64_t> unknowns_, orders_;
  std::vector<double> residual_, boundary_residual_;
  std::vector<Invariant> power_, rounding_, truncation_;
  Placement placement_;
};

extern const DatasetTable spectrum_table;

}  // namespace flatspeckle::wave

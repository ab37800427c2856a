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

/// The exact scattered field of one placement under unit plane waves. Light and view angles in
/// radians (C2), positions in the placement's unit.
class WaveSolution {
 public:
  /// coefficients: beta of TMatrixSystem, [light][unknown].
  WaveSolution(TMatrixSystem system, std::vector<double> light_angles,
               std::vector<Complex> coefficients);

  const TMatrixSystem& system() const { return system_; }
  const std::vector<double>& light_angles() const { return light_angles_; }
  std::vector<int> basis_order() const;
  const Diagnosis& diagnosis() const { return diagnosis_; }
  /// How the equations were solved, in words.
  const std::string& method() const { return method_; }
  /// beta of a light: [unknown].
  std::span<const Complex> coefficients(std::size_t light) const;

  /// Far-field amplitude A of the whole placement (C4), phase origin r = 0.
  Complex far_field(double view_angle, std::size_t light = 0) const;
  /// Scattered field, without the incident one. Throws InputError for a point inside a scatterer.
  Complex near_field(Vec2 point, std::size_t light = 0) const;
  /// Either, for all lights: [light][view].
  std::vector<Complex> fields(std::span<const View> views) const;
  /// Of one light: [view].
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

/// Throws InputError for overlapping scatterers, disks too close to resolve, or too little memory;
/// std::runtime_error where no finite solution is found.
WaveSolution solve(const Placement& placement, double k, const std::vector<double>& light_angles,
                   const SolveOptions& options = {});

extern const DatasetTable solution_table;
/// Writes the fields in these directions and at these points (either may be empty) with their axes,
/// the placement, and how far the solution can be trusted.
void write_solution(ResultFile& file, const WaveSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec2>& sensors);

/// Positions and radii.
void write_placement(ResultFile& file, const Placement& placement);

/// What lights and views need of a placement within a circle, found once for a whole ensemble: the
/// few of many lights, or of many far views, that stand for all (LightBasis).
struct FieldPlan {
  LightBasis lights, far_views;
  std::vector<View> views;
};
FieldPlan make_field_plan(const Lights& lights, std::vector<View> views, double k,
                          const Circle& circle, double tolerance);

/// Fields of a placement, [light][view], without diagnosis; by reciprocity the equations are solved
/// for the fewer of lights and views.
std::vector<Complex> scattered_fields(const Placement& placement, double k, const FieldPlan& plan,
                                      const SolveOptions& options);

/// Fields of one placement at several wavelengths, one after the other, and how far each solution
/// can be trusted: [wavelength][light][view].
class Spectrum {
 public:
  Spectrum(const std::vector<double>& view_angles, const std::vector<Vec2>& sensors);

  void add(double wavelength, const WaveSolution& solution);

  /// With axes and placement.
  void write(ResultFile& file) const;

  /// The worst residual so far.
  double residual() const;
  /// Of the largest system so far.
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

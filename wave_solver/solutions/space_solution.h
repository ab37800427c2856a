#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/scene/scene.h"
#include "wave_solver/solutions/equation_solver.h"
#include "wave_solver/spheres/sphere_equations.h"

namespace flatspeckle::wave {

/// The exact scattered field of one placement of points and spheres in space (C60 to C62).
class SpaceSolution {
 public:
  /// coefficients: beta of SphereEquations, [light][unknown].
  SpaceSolution(SphereEquations equations, Lights lights, std::vector<Complex> coefficients);

  const SphereEquations& equations() const { return equations_; }
  const Lights& lights() const { return lights_; }
  const Diagnosis& diagnosis() const { return diagnosis_; }
  /// Description of the method that solved the equations.
  const std::string& method() const { return method_; }
  /// Coefficients beta for a light: [unknown].
  std::span<const Complex> coefficients(std::size_t light) const;

  /// Returns the amplitudes A in far views (C56), phase origin r = 0, and the scattered fields at
  /// near sensors, without the light itself: [light][view]. Throws InputError for a sensor inside a
  /// sphere or on a point.
  std::vector<Complex> fields(std::span<const View> views) const;

 private:
  friend SpaceSolution solve_in_space(const Placement&, double, const Lights&, const SolveOptions&);

  SphereEquations equations_;
  Lights lights_;
  std::vector<Complex> coefficients_;
  std::string method_;
  Diagnosis diagnosis_;
};

/// Solves the multiple scattering of a placement in space. Throws InputError for overlapping
/// scatterers, spheres too close to resolve, the method fast, or too little memory;
/// std::runtime_error if no finite solution is found.
SpaceSolution solve_in_space(const Placement& placement, double k, const Lights& lights,
                             const SolveOptions& options = {});

extern const DatasetTable space_solution_table;
/// Writes the fields in far views and at near sensors (either list may be empty) with their axes,
/// the placement and the diagnosis. camera: set if the far views are those of a camera.
void write_solution(ResultFile& file, const SpaceSolution& solution,
                    const std::vector<View>& far_views, const std::vector<View>& near_sensors,
                    const std::optional<FarCamera>& camera = {});

/// Solves placements of a scene in space for its lights and views, without diagnosis.
class SpaceFields {
 public:
  SpaceFields(const Scene& scene, const SolveOptions& options);

  /// Returns the fields of a placement, [light][view]. The equations are solved for the lights or,
  /// by reciprocity, for the views, whichever are fewer. May be called by several threads.
  std::vector<Complex> of(const Placement& placement) const;

 private:
  double k_;
  Lights lights_;
  std::vector<View> views_;
  SolveOptions options_;
  // Orders of pairs of spheres, which many placements share, and the lock of these orders.
  std::shared_ptr<BasisOrders> orders_;
  std::shared_ptr<std::mutex> lock_;
};

}  // namespace flatspeckle::wave

#include "wave_solver/solutions/solution_datasets.h"

#include "core/result/result_group.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::wave {

const DatasetTable solution_table{
    "solve",
    {{"far_field", Data::complex, "light_angle view_angle", "length^(1/2)",
      "far-field amplitude A, phase origin at r = 0"},
     {"near_field", Data::complex, "light_angle sensor", "1",
      "scattered field, without the incident wave"},
     {"scatterer", Data::numbers, "", "1", "number of the scatterer"},
     {"placement/x", Data::real, "scatterer", "length", "transverse position"},
     {"placement/z", Data::real, "scatterer", "length", "depth"},
     {"placement/radius", Data::real, "scatterer", "length", "radius, 0 for a point"},
     {"solve/basis_order", Data::count, "scatterer", "1", "highest angular order per scatterer"},
     {"solve/residual", Data::real, "", "1", "relative residual of the unscaled equations"},
     {"solve/condition", Data::real, "", "1", "condition estimate of the scaled matrix, 1-norm"},
     {"solve/boundary_residual", Data::real, "", "1",
      "largest mismatch of the boundary conditions, unit incident waves"}}};

namespace {

void write_views(ResultFile& file, const std::string& name, const WaveSolution& solution,
                 const std::vector<View>& views) {
  if (views.empty()) return;
  write_view_axis(file, views);
  ResultGroup(file, solution_table).put(name, solution.fields(views));
}

void write_diagnosis(const ResultGroup& root, const Diagnosis& diagnosis) {
  root.put("solve/residual", diagnosis.residual);
  if (diagnosis.condition >= 0) root.put("solve/condition", diagnosis.condition);
  root.put("solve/boundary_residual", diagnosis.boundary_residual);
}

}  // namespace

void write_solution(ResultFile& file, const WaveSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec2>& sensors) {
  write_light_axis(file, solution.light_angles());
  write_views(file, "far_field", solution, column(view_angles, far_view));
  write_views(file, "near_field", solution, column(sensors, near_sensor));
  const ResultGroup root(file, solution_table);
  const Placement& placement = solution.system().placement();
  root.number("scatterer", placement.size());
  root.put("placement/x", column(placement, [](const auto& placed) { return placed.position.x; }));
  root.put("placement/z", column(placement, [](const auto& placed) { return placed.position.z; }));
  root.put("placement/radius",
           column(placement, [](const auto& placed) { return placed.scatterer.disk_radius(); }));
  root.put("solve/basis_order", column(solution.basis_order(), std::identity()));
  write_diagnosis(root, solution.diagnosis());
}

}  // namespace flatspeckle::wave

#include "apps/flatland/space_solve.h"

#include <cstdio>
#include <numbers>

#include "core/error.h"
#include "wave_solver/maps/space_map.h"

namespace flatspeckle::apps {

void add_space_solve_keys(Keys& keys, SceneSpec& spec) {
  add_light_keys(keys, spec);
  add_space_keys(keys, spec);
  for (const char* key : {"tilt_azimuth", "pair_azimuths"}) keys.remove(key);
}

SpaceRequest space_request(const Keys& keys, SceneSpec& spec) {
  SpaceRequest request;
  const CovarianceRequest first = make_request(keys, spec);
  request.lights = first.lights;
  if (spec.near_sensors.empty()) {
    request.far_views = first.views;
    request.camera = first.camera;
    return request;
  }
  request.near_sensors = first.views;
  for (const View& sensor : request.near_sensors)
    require_phase("near_sensors", sensor.point, 2 * std::numbers::pi / keys.read(spec.wavelength));
  if (!keys.given(spec.view_angles)) return request;
  std::string sensors;
  sensors.swap(spec.near_sensors);  // without them the views are directions
  const CovarianceRequest second = make_request(keys, spec);
  sensors.swap(spec.near_sensors);
  request.far_views = second.views;
  request.camera = second.camera;
  return request;
}

void require_uniform_space(const Scene& scene) {
  if (scene.profile || scene.index || scene.faces)
    throw InputError("dimension", 3,
                     "the exact solver requires a medium without layers, index_field and "
                     "medium_index");
}

std::string write_space_solution(ResultFile& file, const Placement& placement, double k,
                                 const SpaceRequest& request, wave::SolveOptions options,
                                 bool prints) {
  for (const View& sensor : request.near_sensors) options.sensors.push_back(sensor.point);
  if (request.map)
    for (const Vec& point : wave::map_sensors(*request.map, request.map_y, placement))
      options.sensors.push_back(point);
  const auto solution = wave::solve_in_space(placement, k, request.lights, options);
  wave::write_solution(file, solution, request.far_views, request.near_sensors, request.camera);
  std::string plan = std::to_string(placement.size()) + " scatterers in space, " +
                     std::to_string(solution.equations().unknowns()) +
                     " unknowns: " + solution.method();
  if (request.map)
    plan += "; " + wave::write_map(file, solution, *request.map, request.map_y, options.tolerance);
  if (!prints) return plan;
  const wave::Diagnosis& diagnosis = solution.diagnosis();
  std::printf("%s\nresidual %.1e, ", plan.c_str(), diagnosis.residual);
  if (diagnosis.condition >= 0) std::printf("condition %.1e, ", diagnosis.condition);
  std::printf("boundary residual %.1e\n", diagnosis.boundary_residual);
  return plan;
}

}  // namespace flatspeckle::apps

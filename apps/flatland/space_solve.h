#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "wave_solver/maps/field_map.h"
#include "wave_solver/solutions/space_solution.h"

namespace flatspeckle::apps {

/// Lights and views of `solve` in space.
struct SpaceRequest {
  Lights lights;
  std::vector<View> far_views, near_sensors;  ///< either may be empty
  std::optional<FarCamera> camera;            ///< set if the far views are those of a camera
  std::optional<wave::MapGrid> map;
  double map_y = 0;  ///< y of the plane of the map
};

/// Adds the keys of lights and views in space that the plane does not have.
void add_space_solve_keys(Keys& keys, SceneSpec& spec);

/// Reads lights and views. Views are the near sensors, the directions if they are given, and the
/// default direction if there are no sensors. Throws InputError.
SpaceRequest space_request(const Keys& keys, SceneSpec& spec);

/// Throws InputError unless the medium of a scene in space is uniform, without layers and faces.
void require_uniform_space(const Scene& scene);

/// Solves, writes the solution, and returns the description of the method. prints: whether a
/// summary is printed.
std::string write_space_solution(ResultFile& file, const Placement& placement, double k,
                                 const SpaceRequest& request, wave::SolveOptions options,
                                 bool prints);

}  // namespace flatspeckle::apps

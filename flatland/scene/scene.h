#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "flatland/media/domain.h"
#include "flatland/media/medium.h"
#include "flatland/placement/placement.h"
#include "flatland/request/request.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle {

/// Scene keys as the user gives them; names and meanings as in the README. Lengths in any one unit,
/// angles in radians.
struct SceneSpec {
  double wavelength = 1;
  std::string domain = "box";
  std::optional<double> width, depth;
  std::string scatterer = "point";
  std::optional<double> radius, g, albedo, phase_shift;
  std::optional<std::string> index;
  std::optional<std::int64_t> count;
  std::optional<double> density, mean_free_path, optical_depth;
  std::optional<std::string> placement;
  std::optional<double> min_gap;
  std::string structure = "none";
  std::vector<double> light_angles{0};
  std::string near_sources;
  std::optional<double> beam_waist, beam_depth;
  std::vector<double> beam_positions{};
  std::vector<double> view_angles{0};
  std::string near_sensors;
  std::vector<double> tilts{}, shifts{};
  std::string covariance = "intensity";
  std::vector<double> pairs{};
};

/// All that a solver is told: one scene, two eyes.
struct Scene {
  double wavelength = 1, k = 0;
  Domain domain;
  Scatterer scatterer;
  BulkMedium medium;
  PlacementRule placement;
  CovarianceRequest request;
};

/// The scatterer alone, with k = 2 pi / wavelength; what `solve` needs beside a placement file.
Scatterer make_scatterer(const SceneSpec& spec);
/// Lights, views and entries alone.
CovarianceRequest make_request(const SceneSpec& spec);
/// The infinite slab has far fields only, lights from below the horizon, and (C18) only entries
/// whose transverse momenta match.
void check_slab_request(const CovarianceRequest& request);
/// Checks every key and derives the bulk. Throws InputError naming key, value and what is accepted.
Scene make_scene(const SceneSpec& spec);

/// "1.5", "1.5+0.1i", "0.1 + 5i". Throws InputError.
Complex parse_complex(const std::string& key, const std::string& text);

}  // namespace flatspeckle

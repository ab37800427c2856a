#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "grin/media/fields/any_index_field.h"
#include "grin/media/index/index_field.h"
#include "grin/render/lights/light.h"
#include "grin/render/methods/light_map.h"
#include "grin/render/sensors/sensor.h"
#include "grin/render/stage/stage.h"
#include "grin/render/transport/film.h"

namespace flatspeckle::grin {

/// Everything that light meets.
struct RenderScene {
  AnyIndexField field;
  double step;        ///< of rays in sigma (length at index 1); no use in a homogeneous field
  double max_length;  ///< arc length of one flight or join; longer ones are lost
  bool random_phase = false;  ///< of a StandingWave: each path meets its own (C28)
  Stage stage;
  std::vector<Light> lights;
  std::vector<Sensor> sensors;
  std::vector<std::string> sensor_names = {};  ///< of several
  TimeBins bins = {};
  std::optional<LightMap> map = {};
  std::optional<double> length_unit = {};       ///< metres in a unit of length, for times
  bool leapfrogs = false;                       ///< steps are of Leapfrog (make_ray_field)
  std::optional<IndexRange> index = {};         ///< where it is known
  std::vector<FieldParameter> parameters = {};  ///< by which powers are differentiated
  bool is_silent = false;  ///< there is sound, but none that turns a ray: it is left out
};

/// Of a scene with several sensors; a number where it has no names.
std::string sensor_name(const RenderScene& scene, std::size_t sensor);

enum class RenderMethod { path, light, bidirectional, analog };
/// In their order.
std::vector<std::string> method_words();
std::string method_word(RenderMethod method);

struct RenderRequest {
  std::optional<RenderMethod> method = {};  ///< that which suits the scene if there is none
  std::int64_t max_scatterings = 0;         ///< 0: no limit
};

}  // namespace flatspeckle::grin

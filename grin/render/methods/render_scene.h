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

/// The scene of a render.
struct RenderScene {
  AnyIndexField field;
  double step;        ///< step of rays in sigma (length at index 1); unused in a homogeneous field
  double max_length;  ///< largest arc length of a flight or connection; longer ones are lost
  bool random_phase = false;  ///< each path has a random phase of the sound (StandingWave, C28)
  Stage stage;
  std::vector<Light> lights;
  std::vector<Sensor> sensors;
  std::vector<std::string> sensor_names = {};  ///< names, if there are several sensors
  TimeBins bins = {};
  std::optional<LightMap> map = {};
  /// Metres per unit of length, to convert optical paths to times.
  std::optional<double> length_unit = {};
  bool leapfrogs = false;                       ///< whether steps are by Leapfrog (make_ray_field)
  std::optional<IndexRange> index = {};         ///< range of the index, if known
  std::vector<FieldParameter> parameters = {};  ///< parameters by which powers are differentiated
  bool is_silent = false;  ///< the sound is too weak to bend rays and is left out
};

/// Returns the name of a sensor; its number, from 1, if sensors have no names.
std::string sensor_name(const RenderScene& scene, std::size_t sensor);

enum class RenderMethod { path, light, bidirectional, forward };
/// Key values of the methods, in the order of RenderMethod.
std::vector<std::string> method_words();
std::string method_word(RenderMethod method);

/// Selects what target_error applies to: the mean over the pixels or the total power; each power
/// within radii; or the picture, whose relative error is RMS error over RMS value.
enum class RenderTarget { total, powers, picture };
/// Key values of the targets, in the order of RenderTarget.
std::vector<std::string> target_words();

struct RenderRequest {
  std::optional<RenderMethod> method = {};  ///< nullopt: chosen for the scene
  std::int64_t max_scatterings = 0;         ///< 0: no limit
  std::optional<RenderTarget> target = {};  ///< nullopt: usual_target() of each sensor
};

}  // namespace flatspeckle::grin

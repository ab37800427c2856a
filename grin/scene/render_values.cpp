#include "grin/scene/render_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/keys/number_text.h"

namespace flatspeckle::grin {

namespace {

constexpr const char* chosen = "auto";

std::vector<std::string> words_for_methods() {
  std::vector<std::string> words = method_words();
  words.insert(words.begin(), chosen);
  return words;
}

TimeBins time_bins(const Keys& keys, const RenderValues& values) {
  constexpr double most = 100'000;
  const auto& bins = keys.read(values.path_bins);
  if (bins.empty()) return {};
  const auto refuse = [&](const std::string& accepted) {
    throw InputError("path_bins", number_text(bins), accepted);
  };
  if (!(bins[0] >= 0 && bins[1] > bins[0])) refuse("must go from a length to a larger one");
  if (!(bins[2] >= 2 && bins[2] <= most && bins[2] == std::floor(bins[2])))
    refuse("must have a whole count from 2 to 100000");
  return {bins[0], bins[1], static_cast<int>(bins[2])};
}

void check_size(const std::vector<Sensor>& sensors, const TimeBins& bins) {
  constexpr double most = 1 << 23;  // of which 16 groups of sums are 2 GiB
  double size = 0;
  for (const Sensor& sensor : sensors)
    size += static_cast<double>(picture_of(sensor).grid().count()) * bins.count;
  if (size > most) throw InputError("pixels x path_bins", size, "must be at most 8388608");
}

/// Sound of amplitude 0 bends no rays.
AnyIndexField without_silence(const AnyIndexField& field) {
  return std::visit(
      [](const auto& of) -> AnyIndexField {
        if constexpr (requires { of.amplitude(); })
          if (of.amplitude() == 0) return Homogeneous{of.background()};
        return of;
      },
      field);
}

double step_of(const Keys& keys, const RenderValues& values, double scale, double size) {
  constexpr double parts = 10;  // a fourth-order step then errs by about 1e-6
  constexpr double most_steps = 1e5;
  const double usual = scale > 0 ? std::min(scale / parts, size) : size;
  const double step = scale > 0 ? keys.read(values.step).value_or(usual) : usual;
  if (!(step * most_steps >= size))
    throw InputError("step", step,
                     "must be at least 1e-5 of the stage's size: " + number_text(size));
  if (scale > 0 && step > scale)
    throw InputError("step", step, "must be at most the field's scale: " + number_text(scale));
  return step;
}

double max_length_of(const Keys& keys, const RenderValues& values, double scale, double size) {
  const double usual = 10 * size;
  return scale > 0 ? keys.read(values.max_length).value_or(usual) : usual;
}

}  // namespace

void add_keys(Keys& keys, RenderValues& values) {
  add_keys(keys, values.field);
  keys.group("Rays", "a field that bends rays");
  keys.add("random_phase", values.random_phase, "Each path meets the sound at a phase of its own")
      .only_of("ultrasound, focused_sound");
  keys.add("step", values.step,
           "Equal steps of rays, length at index 1 (default: a tenth of the field's scale)")
      .positive()
      .unit("length");
  keys.add("max_length", values.max_length,
           "Arc length of one flight between scatterings, at the most (default: 10 times the "
           "stage's size)")
      .positive()
      .unit("length");
  add_keys(keys, values.stage);
  add_keys(keys, values.lights);
  add_keys(keys, values.sensors);
  keys.group("Picture");
  keys.add("path_bins", values.path_bins,
           "first last count: also pictures by optical path, in equal bins of it, shared between "
           "the two nearest middles")
      .exactly(3, "three numbers: first last count");
  keys.add("length_unit", values.length_unit,
           "Metres in a unit of length, for the times of path_bins")
      .positive();
}

void add_keys(Keys& keys, RenderRequestValues& values) {
  keys.group("Method");
  keys.add("method", values.method,
           "Path tracing is from the sensor; light tracing is best for powers on large areas; "
           "auto: chosen by a pilot")
      .one_of(words_for_methods());
  keys.add("photon_radius", values.photon_radius,
           "Radius of the estimate (default: chosen from the scene)")
      .positive()
      .unit("length")
      .only_of("photon_map");
  keys.add("max_scatterings", values.max_scatterings,
           "Paths of more scatterings are left out; 0: no limit")
      .from(0, std::numeric_limits<int>::max());
}

RenderScene make_render_scene(const Keys& keys, const RenderValues& values) {
  const bool any_phase = keys.read(values.random_phase);
  const auto [stage, field] = make_stage(keys, values.stage, values.field, any_phase);
  const Box box = bounds(stage.boundary);
  const double size = (box.high - box.low).norm();
  const AnyIndexField heard = without_silence(field.field);
  RenderScene scene{.field = heard,
                    .step = step_of(keys, values, field.scale, size),
                    .max_length = max_length_of(keys, values, field.scale, size),
                    .random_phase = any_phase && heard.index() == field.field.index(),
                    .stage = stage,
                    .lights = make_lights(keys, values.lights),
                    .sensors = make_sensors(keys, values.sensors),
                    .sensor_names = make_sensor_names(keys, values.sensors),
                    .bins = time_bins(keys, values),
                    .length_unit = keys.read(values.length_unit)};
  check_size(scene.sensors, scene.bins);
  return scene;
}

RenderScene make_render_scene(const RenderValues& values) {
  return made_of(values, [](const Keys& keys, const RenderValues& all) {
    return make_render_scene(keys, all);
  });
}

RenderRequest make_render_request(const Keys& keys, const RenderRequestValues& values) {
  RenderRequest request{.max_scatterings = keys.read(values.max_scatterings)};
  const auto words = method_words();
  if (const auto& method = keys.read(values.method); method != chosen)
    request.method =
        static_cast<RenderMethod>(std::find(words.begin(), words.end(), method) - words.begin());
  if (request.method == RenderMethod::photon_map)
    request.photon_radius = keys.read(values.photon_radius).value_or(0);
  return request;
}

RenderRequest make_render_request(const RenderRequestValues& values) {
  return made_of(values, [](const Keys& keys, const RenderRequestValues& all) {
    return make_render_request(keys, all);
  });
}

}  // namespace flatspeckle::grin

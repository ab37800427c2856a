#include "grin/render/values/render_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/keys/number_text.h"
#include "core/keys/written_number.h"
#include "grin/media/fields/any_index_field.h"
#include "grin/media/fields/scene_field.h"
#include "grin/render/sensors/sensor_edges.h"
#include "grin/render/transport/path_score.h"
#include "grin/render/values/step_choice.h"

namespace flatspeckle::grin {

namespace {

std::optional<Surface> given_boundary(const Keys& keys, const StageValues& values) {
  std::vector<Surface> given;
  for (const Box& box : boxes_of(keys, values.stage_box)) given.push_back(box);
  for (const Sphere& sphere : spheres_of(keys, values.stage_sphere)) given.push_back(sphere);
  return one_surface("stage", "stage_box, stage_sphere", given);
}

/// Largest distance of a surface from the z axis.
double reach_of(const Surface& surface) {
  const Box box = bounds(surface);
  const Vec3 far = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs());
  return std::hypot(far[0], far[1]);
}

/// Throws InputError if a density grid does not overlap its medium, which would be empty then.
void check_overlap(const ScatteringMedium& medium, const Surface& region, const std::string& key,
                   const std::string& name) {
  if (!medium.density) return;
  const Box grid{medium.density->grid().origin, medium.density->grid().end()};
  if (are_apart(grid, bounds(region)))
    throw InputError(key + ": the grid, from " + listed(grid.low) + " to " + listed(grid.high) +
                     ", is outside of the " + name);
}

ScatteringMedium medium_in(const Keys& keys, const MediumValues& values, const Surface& region,
                           const std::string& name) {
  const ScatteringMedium medium = make_medium(keys, values);
  check_overlap(medium, region, keys.name(values.density), name);
  return medium;
}

/// Returns the body given by keys, or the ball of a field that ends at its rim.
std::optional<Surface> body_of(const SceneField& field, const Surface& boundary,
                               const std::optional<Surface>& body) {
  if (body) check_rim(field, *body);
  if (body || !field.rim || lies_in(boundary, *field.rim)) return body;
  if (std::holds_alternative<AnySum>(field.field))
    throw InputError("field: luneburg in a sum requires a stage or a body inside of its rim");
  return *field.rim;
}

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw InputError("gradient_by", name, why);
}

/// One of the numbers of a key, by which the result is to be differentiated.
struct FieldNumber {
  std::string key;
  std::size_t which = 0;
  std::vector<std::string> texts;  ///< all numbers of the key

  double value() const { return read_number(texts[which]).value_or(0); }
};

/// Returns the key of this name; null if there is none. Several kinds of fields may have a key of
/// the same name; one that is given takes precedence.
const Key* key_of(const Keys& keys, const std::string& name) {
  const Key* found = nullptr;
  for (const Key& key : keys.rows())
    if (key.name() == name && (!found || key.given())) found = &key;
  return found;
}

FieldNumber number_of(const Keys& keys, const std::string& name) {
  const auto dot = name.find('.');
  FieldNumber number{name.substr(0, dot), 0, {}};
  const Key* const key = key_of(keys, number.key);
  if (!key || !key->is_number() || key->is_whole() || key->value().empty())
    refuse(name,
           "must be a given number of the index field, such as amplitude or transducer.2 (for "
           "mu_s, mu_a and g use gradient)");
  number.texts = key->value();
  const bool has_part = dot != std::string::npos;
  const auto part = has_part ? read_whole_number(name.substr(dot + 1)) : std::optional(0L);
  if (!part || *part < 0 || static_cast<std::size_t>(*part) >= number.texts.size() ||
      has_part != (number.texts.size() > 1))
    refuse(name, "has " + std::to_string(number.texts.size()) +
                     " numbers; in a key of several numbers, the first is " + number.key + ".0");
  number.which = static_cast<std::size_t>(*part);
  return number;
}

AnyIndexField field_with(const IndexFieldValues& values, FieldNumber number, double value,
                         const FieldUse& use) {
  const Keyed<IndexFieldValues> keyed(values);
  number.texts[number.which] = number_text(value);
  keyed.keys.set(number.key, number.texts);
  const SceneField made = make_scene_field(keyed.keys, keyed.values, use);
  keyed.keys.refuse_unread();
  return made.field;
}

/// Returns, for each name of a number of the index field, the fields with that number decreased and
/// increased, from which derivatives by the number are computed. If a key has several numbers,
/// name.2 is the third of them. Throws InputError (gradient_by) for names that are not numbers of
/// the field.
std::vector<FieldParameter> field_parameters(const IndexFieldValues& values,
                                             const std::vector<std::string>& names,
                                             const FieldUse& use) {
  constexpr double apart = 1e-5;
  const Keyed<IndexFieldValues> keyed(values);
  std::vector<FieldParameter> parameters;
  for (const std::string& name : names) {
    const FieldNumber number = number_of(keyed.keys, name);
    const double value = number.value(), scale = value == 0 ? 1 : std::abs(value);
    const double step = apart * scale;
    parameters.push_back({name, scale, step, field_with(values, number, value - step, use),
                          field_with(values, number, value + step, use)});
  }
  return parameters;
}

constexpr const char* chosen = "auto";

std::vector<std::string> words_for_methods() {
  std::vector<std::string> words = method_words();
  words.insert(words.begin(), chosen);
  return words;
}

std::vector<std::string> words_for_targets() {
  std::vector<std::string> words = target_words();
  words.insert(words.begin(), chosen);
  return words;
}

TimeBins time_bins(const Keys& keys, const RenderValues& values) {
  constexpr double most = 100'000;
  const auto& bins = keys.read(values.path_bins);
  const bool moments = keys.read(values.path_moments);
  if (bins.empty()) return {.moments = moments};
  const auto refuse = [&](const std::string& accepted) {
    throw InputError("path_bins", number_text(bins), accepted);
  };
  if (!(bins[0] >= 0 && bins[1] > bins[0]))
    refuse("must have a first length of at least 0, and a larger last length");
  if (!(bins[2] >= 2 && bins[2] <= most && bins[2] == std::floor(bins[2])))
    refuse("must have a whole count from 2 to 100000");
  return {bins[0], bins[1], static_cast<int>(bins[2]), moments};
}

constexpr double most_sums = 1 << 23;  // 16 groups of this many sums take 2 GiB

void check_size(const std::vector<Sensor>& sensors, const TimeBins& bins) {
  double size = 0;
  for (const Sensor& sensor : sensors)
    size += static_cast<double>(pixels_of(sensor).grid.count()) * bins.sums();
  if (size > most_sums) throw InputError("pixels x path_bins", size, "must be at most 8388608");
}

/// Returns the field; if it is sound too weak to bend rays, its homogeneous background instead.
AnyIndexField without_silence(const SceneField& field, const Stage& stage) {
  if (!bends_nothing(field, stage)) return field.field;
  return std::visit(
      [](const auto& of) -> AnyIndexField {
        if constexpr (requires { of.amplitude(); })
          return Homogeneous{of.background()};
        else
          return of;
      },
      field.field);
}

bool has_sound(const AnyIndexField& field) {
  return std::visit(
      [](const auto& of) {
        if constexpr (requires { of.amplitude(); })
          return of.amplitude() != 0;
        else
          return false;
      },
      field);
}

StepChoice steps_of(const Keys& keys, const RenderValues& values, const SceneField& field,
                    const Stage& stage, double size) {
  constexpr double most_steps = 1e5;
  if (!(field.scale > 0)) return {size};
  const auto& given = keys.read(values.step);
  const double longest = longest_step(field, stage);
  if (given && *given > longest)
    throw InputError("step", *given,
                     "must be at most " + number_text(longest) + ": the field varies over " +
                         number_text(field.scale));
  const StepChoice steps =
      given ? StepChoice{*given} : chosen_steps(field, stage, keys.read(values.random_phase));
  if (!(steps.step * most_steps >= size))
    throw InputError("step", steps.step,
                     "must be at least 1e-5 of the stage's size: " + number_text(size));
  return steps;
}

double max_length_of(const Keys& keys, const RenderValues& values, double scale, double size) {
  const double usual = 10 * size;
  return scale > 0 ? keys.read(values.max_length).value_or(usual) : usual;
}

/// Requests derivatives by the parameters of the stage's only medium (key gradient).
void add_derivatives(RenderScene& scene) {
  const auto refuse = [](const std::string& why) { throw InputError("gradient: " + why); };
  if (!scene.stage.bodies.empty()) refuse("the stage must have a single medium: leave out bodies");
  const ScatteringMedium& medium = scene.stage.medium;
  if (!medium.is_uniform()) refuse("the medium must be uniform: leave out density and labels");
  if (!(medium.mu_t() > 0)) refuse("the stage must have a medium: mu_s or mu_a must be positive");
  scene.bins.derivatives = static_cast<int>(parameters_of(medium).size());
}

/// Requests derivatives by numbers of the index field (key gradient_by).
void add_motion(const RenderValues& values, const FieldUse& use, RenderScene& scene) {
  const auto refuse = [](const std::string& why) { throw InputError("gradient_by: " + why); };
  if (scene.is_silent || std::holds_alternative<Homogeneous>(scene.field))
    refuse("the field must bend rays; sound requires a nonzero amplitude");
  if (scene.random_phase) refuse("the sound must have a fixed phase: leave out random_phase");
  if (!scene.stage.bodies.empty()) refuse("the stage must have a single medium: leave out bodies");
  if (!scene.stage.medium.is_uniform())
    refuse("the medium must be uniform: leave out density and labels");
  const auto* box = std::get_if<Box>(&scene.stage.boundary);
  if (!box) refuse("the stage must be a box");
  for (const Sensor& sensor : scene.sensors) SensorEdges(sensor, *box, 0);
  scene.parameters = field_parameters(values.field, values.gradient_by, use);
  scene.bins.by_field = static_cast<int>(scene.parameters.size()) * edge_widths;
}

/// Requests the field correlation after delays (key delays).
void add_decay(const Keys& keys, const RenderValues& values, RenderScene& scene) {
  FieldDecay decay{values.delays, keys.read(values.diffusion)};
  const auto parts = static_cast<std::size_t>(scene.stage.parts());
  if (parts > MomentumTransfer::most_parts)
    throw InputError("delays: at most " + std::to_string(MomentumTransfer::most_parts - 1) +
                     " bodies are possible");
  if (decay.diffusion.empty()) decay.diffusion.assign(parts, 1);
  if (decay.diffusion.size() != parts)
    throw InputError("diffusion", number_text(decay.diffusion),
                     "must have a value for the stage and one for each body, from the largest to "
                     "the smallest: " +
                         std::to_string(parts));
  scene.bins.decay = std::make_shared<const FieldDecay>(std::move(decay));
}

}  // namespace

void add_keys(Keys& keys, StageValues& values) {
  constexpr const char *box = "two opposite corners, the low one first",
                       *sphere = "centre and radius";
  keys.group("Stage");
  keys.add("stage_box", values.stage_box,
           "x y z x y z of two corners: light leaves the scene through this box")
      .each_of(6, box)
      .unit("length");
  keys.add("stage_sphere", values.stage_sphere,
           "x y z radius: light leaves the scene through this sphere")
      .each_of(4, sphere)
      .unit("length");
  add_keys(keys, values.medium, "");
  keys.group("Body in the stage");
  add_body_keys(keys, values);
  keys.group("Body in the stage", std::string("a body (") + body_key_names + ")");
  add_index_around(keys, values);
  add_keys(keys, values.body_medium, "body_");
  add_keys(keys, values.plain_bodies);
}

FilledStage make_stage(const Keys& keys, const StageValues& values, const IndexFieldValues& field,
                       bool any_phase, const std::optional<double>& length_unit) {
  const auto boundary = given_boundary(keys, values);
  if (!boundary)
    throw InputError(
        "stage is not given: light needs a boundary through which it leaves (stage_box or "
        "stage_sphere)");
  const auto from_keys = given_body(keys, values, &*boundary);
  const auto given = from_keys ? std::optional(from_keys->surface) : std::nullopt;
  const double reach = reach_of(given ? *given : *boundary);
  const FieldUse use{.reach = reach, .any_phase = any_phase, .length_unit = length_unit};
  FilledStage filled{
      .stage = {.boundary = *boundary}, .field = make_scene_field(keys, field, use), .use = use};
  Stage& stage = filled.stage;
  if (const auto body = body_of(filled.field, *boundary, given)) {
    stage.bodies.push_back({*body, medium_in(keys, values.body_medium, *body, "body")});
    if (from_keys) stage.bodies.back().note = from_keys->note;
    stage.excess_around = keys.read(values.index_around) - 1;
  }
  for (Body& body : make_plain_bodies(keys, values.plain_bodies, length_unit)) {
    check_within(body, *boundary, "stage");
    if (body.is_opaque()) body.excess = -1;  // Interface
    stage.bodies.push_back(std::move(body));
  }
  sort_by_size(stage.bodies);
  stage.medium = medium_in(keys, values.medium, *boundary, "stage");
  check(stage);
  const Part filled_part = stage.field_part();
  filled.index = check_field(filled.field, stage.surface(filled_part),
                             filled_part == around ? "stage" : "body");
  return filled;
}

void add_keys(Keys& keys, RenderValues& values) {
  add_keys(keys, values.field);
  keys.group("Rays", "a field that bends rays");
  keys.add("random_phase", values.random_phase, "Each path has a random phase of the sound")
      .only_of("ultrasound, focused_sound");
  keys.add("step", values.step,
           "Step of curved rays, as a length at index 1 (default: chosen by a pilot run)")
      .positive()
      .unit("length");
  keys.add("max_length", values.max_length,
           "Largest arc length of a flight between scatterings (default: 10 times the stage's "
           "size)")
      .positive()
      .unit("length");
  add_keys(keys, values.stage);
  add_keys(keys, values.lights);
  add_keys(keys, values.sensors);
  keys.group("Picture");
  keys.add("path_bins", values.path_bins,
           "first last count: also computes pictures by optical path, in this number of equal bins "
           "between two optical paths; contributions are split between the two nearest bins")
      .exactly(3, "three numbers: first last count")
      .units("length length 1");
  keys.add(
      "path_moments", values.path_moments,
      "Also computes the mean optical path of the light in each pixel, and the mean of its square");
  keys.add(
      "gradient", values.gradient,
      "Also computes derivatives of pictures and powers by mu_s, mu_a and g (method = forward)");
  keys.add("gradient_by", values.gradient_by,
           "Also computes derivatives by these numbers of the index field, such as amplitude, or "
           "transducer.2 for the third number of transducer (method = forward)");
  keys.add("delays", values.delays,
           "Also computes the field correlation of the light after these delays k^2 D tau, during "
           "which the scatterers diffuse (method = forward)")
      .not_negative();
  keys.add("diffusion", values.diffusion,
           "Factors on the diffusion constant D: of the stage, then of each body, from the largest "
           "to the smallest (default: 1)")
      .not_negative()
      .only_of("delays");
  add_keys(keys, values.tagging);
  keys.group("Picture");
  keys.add("length_unit", values.length_unit,
           "Unit of length, such as um or 1e-6, for the frequency of sound and the times of "
           "path_bins")
      .positive()
      .unit("m");
  add_keys(keys, values.map);
}

void add_keys(Keys& keys, RenderRequestValues& values) {
  keys.group("Method");
  keys.add("method", values.method,
           "path: paths from the sensor; light: paths from the lights, best for powers on large "
           "areas; bidirectional: both, connected; forward: photon tracing without connections; "
           "auto: chosen by a pilot run")
      .one_of(words_for_methods())
      .formerly("analog", "forward")
      .gone("; photon_map is a baseline of `bench error`");
  keys.add("target", values.target,
           "What target_error applies to. total: the mean over the pixels or the total power; "
           "powers: "
           "each power within radii; picture: RMS error of the pixels over their RMS value; auto: "
           "powers with radii, total for a single pixel, else picture")
      .one_of(words_for_targets());
  keys.add("max_scatterings", values.max_scatterings,
           "Largest number of scatterings of a path; longer paths are left out; 0: no limit")
      .from(0, std::numeric_limits<int>::max());
}

RenderScene make_render_scene(const Keys& keys, const RenderValues& values) {
  const bool any_phase = keys.read(values.random_phase);
  auto [stage, field, index, use] =
      make_stage(keys, values.stage, values.field, any_phase, keys.read(values.length_unit));
  const auto sound = make_tagging(keys, values.tagging, stage.field_part(), field);
  const Box box = bounds(stage.boundary);
  const double size = (box.high - box.low).norm();
  const AnyIndexField heard = without_silence(field, stage);
  const StepChoice steps = steps_of(keys, values, field, stage, size);
  RenderScene scene{.field = heard,
                    .step = steps.step,
                    .max_length = max_length_of(keys, values, field.scale, size),
                    .random_phase = any_phase && heard.index() == field.field.index(),
                    .stage = stage,
                    .lights = make_lights(keys, values.lights),
                    .sensors = make_sensors(keys, values.sensors),
                    .sensor_names = make_sensor_names(keys, values.sensors),
                    .bins = time_bins(keys, values),
                    .map = light_map(keys, values.map, box),
                    .length_unit = keys.read(values.length_unit),
                    .leapfrogs = steps.leapfrogs,
                    .index = index,
                    .is_silent = has_sound(field.field) && heard.index() != field.field.index()};
  scene.bins.sound = sound;
  if (keys.read(values.gradient)) add_derivatives(scene);
  if (!keys.read(values.gradient_by).empty()) add_motion(values, use, scene);
  if (!keys.read(values.delays).empty()) add_decay(keys, values, scene);
  check_size(scene.sensors, scene.bins);
  if (scene.sensors.empty() && !scene.map)
    throw InputError("sensor", "none", "requires map_box or map_cylinder");
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
  const auto targets = target_words();
  if (const auto& target = keys.read(values.target); target != chosen)
    request.target = static_cast<RenderTarget>(std::find(targets.begin(), targets.end(), target) -
                                               targets.begin());
  return request;
}

RenderRequest make_render_request(const RenderRequestValues& values) {
  return made_of(values, [](const Keys& keys, const RenderRequestValues& all) {
    return make_render_request(keys, all);
  });
}

}  // namespace flatspeckle::grin

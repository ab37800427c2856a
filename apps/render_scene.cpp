#include "apps/render_scene.h"

#include <cmath>

#include "apps/key_values.h"
#include "core/error.h"
#include "core/result/file_checksum.h"

namespace flatspeckle::apps {

namespace {

grin::TimeBins time_bins(const RenderSpec& spec) {
  constexpr double most = 100'000;
  const auto& bins = spec.path_bins;
  if (bins.empty()) return {};
  if (bins.size() != 3)
    throw InputError("path_bins", listed(bins), "must be three numbers: first last count");
  finite("path_bins", bins);
  if (!(bins[0] >= 0 && bins[1] > bins[0]))
    throw InputError("path_bins", listed(bins), "must go from a length to a larger one");
  if (!(bins[2] >= 2 && bins[2] <= most && bins[2] == std::floor(bins[2])))
    throw InputError("path_bins", listed(bins), "must have a whole count from 2 to 100000");
  return {bins[0], bins[1], static_cast<int>(bins[2])};
}

void check_size(const grin::Sensor& sensor, const grin::TimeBins& bins) {
  constexpr double most = 1 << 23;  // of which 16 groups of sums are 2 GiB
  const int pixels = std::visit([](const auto& kind) { return kind.pixels.count(); }, sensor);
  const double size = static_cast<double>(pixels) * bins.count;
  if (size > most) throw InputError("pixels x path_bins", size, "must be at most 8388608");
}

/// Sound of amplitude 0 bends no rays.
bool is_silent(const RenderSpec& spec, const grin::AnyIndexField& field) {
  return spec.field.amplitude == 0 && (std::holds_alternative<grin::StandingWave>(field) ||
                                       std::holds_alternative<grin::FocusedSound>(field));
}

grin::AnyIndexField field_of(const RenderSpec& spec, const grin::AnyIndexField& field) {
  if (!is_silent(spec, field)) return field;
  return grin::Homogeneous{spec.field.index.value_or(1) - 1};
}

void check_unused(const Subcommand& command, const RenderSpec& spec, const SceneField& field) {
  if (spec.random_phase && command.given("sound_phase"))
    throw InputError("sound_phase: random_phase has no use for it");
  for (const std::string key : {"step", "max_length"})
    if (field.scale == 0 && command.given(key))
      throw InputError(key + ": rays in a homogeneous field are straight and have no use for it");
}

double step_of(const RenderSpec& spec, double scale, double size) {
  constexpr double parts = 10;  // a fourth-order step then errs by about 1e-6
  constexpr double most_steps = 1e5;
  const double step = spec.step   ? positive("step", *spec.step)
                      : scale > 0 ? std::min(scale / parts, size)
                                  : size;
  if (!(step * most_steps >= size))
    throw InputError("step", step, "must be at least 1e-5 of the stage's size: " + listed({size}));
  if (scale > 0 && step > scale)
    throw InputError("step", step, "must be at most the field's scale: " + listed({scale}));
  return step;
}

}  // namespace

void add_render_options(Options& options, RenderSpec& spec) {
  add_index_field_options(options, spec.field);
  add_stage_options(options, spec.stage);
  add_light_options(options, spec.lights);
  add_sensor_options(options, spec.sensor);
  options.add(
      "--path_bins", spec.path_bins,
      "first last count: also pictures by optical path, in equal bins of it, shared between "
      "the two nearest middles");
  options.add("--length_unit", spec.length_unit,
              "Metres in a unit of length, for the times of path_bins");
  options.add("--method", spec.method,
              "bidirectional (default), path (tracing, from the sensor), light (tracing: best for "
              "powers on large areas) or photon_map");
  options.add("--photon_radius", spec.photon_radius,
              "photon_map: radius of the estimate (default: chosen from the scene)");
  options.add("--max_scatterings", spec.max_scatterings,
              "Paths of more scatterings are left out (default 0: no limit)");
  options.add_flag("--random_phase", spec.random_phase,
                   "ultrasound, focused_sound: each path meets the sound at a phase of its own");
  options.add("--step", spec.step,
              "Equal steps of rays, length at index 1 (default: a tenth of the field's scale)");
  options.add("--max_length", spec.max_length,
              "Arc length of one flight between scatterings, at the most (default: 10 times the "
              "stage's size)");
}

grin::RenderRequest make_render_request(const RenderSpec& spec) {
  using Method = grin::RenderMethod;
  grin::RenderRequest request;
  if (spec.method == "path")
    request.method = Method::path;
  else if (spec.method == "light")
    request.method = Method::light;
  else if (spec.method == "photon_map")
    request.method = Method::photon_map;
  else if (spec.method != "bidirectional")
    throw InputError("method", spec.method, "must be one of bidirectional light path photon_map");
  request.max_scatterings = spec.max_scatterings;
  if (!spec.photon_radius) return request;
  if (request.method != Method::photon_map)
    throw InputError("photon_radius: method (" + spec.method + ") has no use for it");
  request.photon_radius = positive("photon_radius", *spec.photon_radius);
  return request;
}

grin::RenderScene make_render_scene(const Subcommand& command, const RenderSpec& spec) {
  const FilledStage filled = make_stage(command, spec.stage, spec.field);
  check_unused(command, spec, filled.field);
  const grin::Box box = bounds(filled.stage.boundary);
  const double size = (box.high - box.low).norm();
  const grin::AnyIndexField& field = filled.field.field;
  grin::RenderScene scene{.field = field_of(spec, field),
                          .step = step_of(spec, filled.field.scale, size),
                          .max_length = positive("max_length", spec.max_length.value_or(10 * size)),
                          .random_phase = spec.random_phase && !is_silent(spec, field),
                          .stage = filled.stage,
                          .lights = make_lights(spec.lights),
                          .sensor = make_sensor(command, spec.sensor),
                          .bins = time_bins(spec)};
  check_size(scene.sensor, scene.bins);
  return scene;
}

std::optional<double> length_unit_of(const RenderSpec& spec) {
  if (!spec.length_unit) return std::nullopt;
  return positive("length_unit", *spec.length_unit);
}

std::string inputs_text(const RenderSpec& spec) {
  std::string text;
  for (const auto& path : {spec.field.blobs, spec.field.grid, spec.stage.medium.density,
                           spec.stage.body_medium.density})
    if (!path.empty()) text += path + ' ' + std::to_string(file_checksum(path)) + '\n';
  return text;
}

}  // namespace flatspeckle::apps

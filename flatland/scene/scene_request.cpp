#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/chosen.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

namespace {

const std::vector<double>& at_least_one(const Keys& keys, const std::vector<double>& numbers) {
  if (numbers.empty())
    throw InputError(keys.name(numbers) + " = []: must contain at least one number");
  return keys.read(numbers);
}

Lights near_lights(const Keys& keys, const SceneSpec& spec) {
  Lights lights;
  for (const Vec2& point : read_points("near_sources", keys.read(spec.near_sources)))
    lights.push_back(point_source(point));
  return lights;
}

/// Returns a beam for every combination of an angle and a position of the focus.
Lights beams(const Keys& keys, const SceneSpec& spec) {
  const double waist = *keys.read(spec.beam_waist);
  if (waist < spec.wavelength)
    throw InputError("beam_waist", waist,
                     "must be at least one wavelength, because beams are paraxial");
  auto positions = keys.read(spec.beam_positions);
  if (positions.empty()) positions = {0};
  const double depth = keys.read(spec.beam_depth).value_or(0);
  Lights lights;
  for (double angle : at_least_one(keys, spec.light_angles))
    for (double x : positions) lights.push_back(gaussian_beam(angle, {x, depth}, waist));
  return lights;
}

Lights requested_lights(const Keys& keys, const SceneSpec& spec) {
  if (!spec.near_sources.empty()) return near_lights(keys, spec);
  if (spec.beam_waist) return beams(keys, spec);
  return at_least_one(keys, spec.light_angles);
}

Light only_light(const Keys& keys, const SceneSpec& spec) {
  const Lights lights = requested_lights(keys, spec);
  if (lights.size() != 1)
    throw InputError("covariance", spec.covariance,
                     "requires one light, not " + std::to_string(lights.size()));
  return lights.front();
}

/// Returns the near sensors if the key near_sensors is given, otherwise the far views.
std::vector<View> requested_views(const Keys& keys, const SceneSpec& spec) {
  if (spec.near_sensors.empty()) return far_views(at_least_one(keys, spec.view_angles));
  std::vector<View> views;
  for (const Vec2& point : read_points("near_sensors", keys.read(spec.near_sensors)))
    views.push_back(near_sensor(point));
  return views;
}

void no_repeats(const std::string& key, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto twice = std::adjacent_find(values.begin(), values.end());
  if (twice != values.end()) throw InputError(key, *twice, "is given twice");
}

CovarianceRequest memory_effect(const Keys& keys, const SceneSpec& spec) {
  if (at_least_one(keys, spec.light_angles).size() != 1)
    throw InputError("light_angles", spec.light_angles.size(),
                     "memory_effect requires one light: give one angle");
  if (!requested_lights(keys, spec).all(Light::Kind::plane))
    throw InputError(
        "covariance", "memory_effect",
        "requires a plane wave; use tilt_shift for a beam, translation for a near source");
  no_repeats("tilts", at_least_one(keys, spec.tilts));
  no_repeats("view_angles", at_least_one(keys, spec.view_angles));
  return memory_effect_request(2 * std::numbers::pi / spec.outside_wavelength(),
                               spec.light_angles[0], spec.view_angles, spec.tilts);
}

/// Checks that a list of tilts or shifts contains the value 0, and no value twice. The value 0 is
/// the reference, from which the range of a correlation is measured.
void steps_from_zero(const std::string& key, const std::vector<double>& steps) {
  no_repeats(key, steps);
  if (std::find(steps.begin(), steps.end(), 0.0) == steps.end())
    throw InputError(key, steps.front(), "the list must contain 0, the reference");
}

std::vector<View> moved_views(const Keys& keys, const SceneSpec& spec) {
  auto views = requested_views(keys, spec);
  no_repeats("view_angles", spec.view_angles);
  return views;
}

CovarianceRequest tilt_shift(const Keys& keys, const SceneSpec& spec) {
  const Light light = only_light(keys, spec);
  if (light.kind == Light::Kind::point)
    throw InputError("near_sources", spec.near_sources,
                     "a point source has no direction to tilt: use covariance = translation");
  steps_from_zero("tilts", at_least_one(keys, spec.tilts));
  steps_from_zero("shifts", at_least_one(keys, spec.shifts));
  return tilt_shift_request(2 * std::numbers::pi / spec.outside_wavelength(), light,
                            moved_views(keys, spec), spec.tilts, spec.shifts);
}

CovarianceRequest translation(const Keys& keys, const SceneSpec& spec) {
  const Light light = only_light(keys, spec);
  if (light.kind == Light::Kind::plane)
    throw InputError("covariance", "translation",
                     "requires a beam or a near source; for a plane wave use tilt_shift");
  steps_from_zero("shifts", at_least_one(keys, spec.shifts));
  return translation_request(light, moved_views(keys, spec), spec.shifts);
}

CovarianceRequest angle_pairs(const Keys& keys, const SceneSpec& spec) {
  const auto& angles = at_least_one(keys, spec.pairs);
  std::vector<AnglePair> pairs;
  for (std::size_t i = 0; i < angles.size(); i += 4)
    pairs.push_back({angles[i], angles[i + 1], angles[i + 2], angles[i + 3]});
  return pairs_request(pairs);
}

}  // namespace

CovarianceRequest make_request(const Keys& keys, const SceneSpec& spec) {
  using Request = CovarianceRequest::Kind;
  switch (chosen<Request>(request_words, keys.read(spec.covariance))) {
    case Request::memory_effect:
      return memory_effect(keys, spec);
    case Request::tilt_shift:
      return tilt_shift(keys, spec);
    case Request::translation:
      return translation(keys, spec);
    case Request::pairs:
      return angle_pairs(keys, spec);
    case Request::full:
      return full_request(requested_lights(keys, spec), requested_views(keys, spec));
    case Request::intensity:
      break;
  }
  return intensity_request(requested_lights(keys, spec), requested_views(keys, spec));
}

namespace {

/// Checks that near sources and sensors are outside the slab, and that not both the lights and the
/// views are near. If the lights are near, the directions of the far views determine which fields
/// correlate, and vice versa.
void check_near_endpoints(const CovarianceRequest& request, double depth) {
  const bool near_lights = !request.lights.all(Light::Kind::plane);
  for (const Light& light : request.lights)
    if (light.kind == Light::Kind::point && light.point.z >= 0)
      throw InputError("near_sources", light.point.z,
                       "must be below 0, because light enters a slab at z = 0");
  for (const View& view : request.views) {
    if (!view.near) continue;
    if (near_lights)
      throw InputError(
          "near_sensors: a slab lit by a beam or a near source requires far views; or "
          "use a box");
    if (view.point.z >= 0 && view.point.z <= depth)
      throw InputError("near_sensors", view.point.z,
                       "must be outside of the slab: z < 0 or > depth");
  }
}

}  // namespace

void check_slab_request(const CovarianceRequest& request, double depth) {
  for (const Light& light : request.lights)
    if (light.kind != Light::Kind::point && std::cos(light.angle) <= 0)
      throw InputError("light_angles", light.angle,
                       "|angle| must be below pi/2, because light enters a slab at z = 0");
  if (has_near_endpoints(request)) return check_near_endpoints(request, depth);
  if (request.kind == CovarianceRequest::Kind::tilt_shift)
    throw InputError("covariance", "tilt_shift",
                     "on an infinite slab only matched views correlate: use memory_effect, or a "
                     "box");
  constexpr double tolerance = 1e-9;
  const auto momentum = [&](Channel c) {
    return std::sin(request.lights[c.light].angle) - std::sin(request.views[c.view].angle);
  };
  for (const auto& entry : request.entries) {
    if (std::abs(momentum(request.channels[entry.a]) - momentum(request.channels[entry.b])) >
        tolerance)
      throw InputError(
          "covariance: on an infinite slab only pairs with sin(light) - sin(view) unchanged "
          "correlate (the others are exactly 0); use intensity or memory_effect, or a box");
  }
}

}  // namespace flatspeckle

#include <algorithm>
#include <array>
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
  for (const Vec& point :
       read_points("near_sources", keys.read(spec.near_sources), spec.dimension == 3))
    lights.push_back(point_source(point));
  return lights;
}

/// Returns the azimuth of angle number i. azimuths: one for each of `count` angles, one for all, or
/// none (0). In the plane the list is not read, so that the key is refused if it is given.
double azimuth(const Keys& keys, const SceneSpec& spec, const std::vector<double>& azimuths,
               std::size_t i, std::size_t count) {
  if (spec.dimension != 3 || keys.read(azimuths).empty()) return 0;
  if (azimuths.size() != 1 && azimuths.size() != count)
    throw InputError(
        keys.name(azimuths), azimuths.size(),
        "azimuths: must be one for all angles, or one for each of the " + std::to_string(count));
  return azimuths.size() == 1 ? azimuths.front() : azimuths[i];
}

/// Returns the azimuth of tilts and shifts of a light.
double tilt_azimuth(const Keys& keys, const SceneSpec& spec, const Light& light) {
  if (spec.dimension != 3) return 0;
  return light.azimuth + keys.read(spec.tilt_azimuth).value_or(0);
}

Lights plane_waves(const Keys& keys, const SceneSpec& spec) {
  const auto& angles = at_least_one(keys, spec.light_angles);
  Lights lights;
  for (std::size_t i = 0; i < angles.size(); ++i)
    lights.push_back(
        plane_wave(angles[i], azimuth(keys, spec, spec.light_azimuths, i, angles.size())));
  return lights;
}

std::vector<View> directions_of_view(const Keys& keys, const SceneSpec& spec) {
  const auto& angles = at_least_one(keys, spec.view_angles);
  std::vector<View> views;
  for (std::size_t i = 0; i < angles.size(); ++i)
    views.push_back(far_view(angles[i], azimuth(keys, spec, spec.view_azimuths, i, angles.size())));
  return views;
}

/// Returns the camera if the scene has one.
std::optional<FarCamera> camera(const Keys& keys, const SceneSpec& spec) {
  if (spec.dimension != 3 || !keys.read(spec.camera_pixels)) return std::nullopt;
  const auto axes = directions_of_view(keys, spec);
  if (axes.size() != 1)
    throw InputError("view_angles", axes.size(), "directions: a camera has one, that of its axis");
  if (!keys.read(spec.camera_aperture))
    throw InputError("camera_aperture is not given: a camera requires it");
  return FarCamera{axes.front().direction(), *spec.camera_aperture,
                   static_cast<std::size_t>(*spec.camera_pixels)};
}

/// Returns a beam for every combination of an angle and a position of the focus.
Lights beams(const Keys& keys, const SceneSpec& spec) {
  const double waist = *keys.read(spec.beam_waist);
  if (waist < spec.wavelength)
    throw InputError("beam_waist", waist,
                     "must be at least one wavelength, because beams are paraxial");
  auto positions = keys.read(spec.beam_positions);
  if (positions.empty()) positions = {0};
  const double depth = keys.read(spec.beam_depth).value_or(0),
               y = spec.dimension == 3 ? keys.read(spec.beam_y).value_or(0) : 0;
  Lights lights;
  for (const Light& wave : plane_waves(keys, spec))
    for (double x : positions)
      lights.push_back(gaussian_beam(wave.angle, {x, depth, y}, waist, wave.azimuth));
  return lights;
}

Lights requested_lights(const Keys& keys, const SceneSpec& spec) {
  if (!spec.near_sources.empty()) return near_lights(keys, spec);
  if (spec.beam_waist) return beams(keys, spec);
  return plane_waves(keys, spec);
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
  if (spec.near_sensors.empty()) {
    const auto of_camera = camera(keys, spec);
    return of_camera ? of_camera->views() : directions_of_view(keys, spec);
  }
  std::vector<View> views;
  for (const Vec& point :
       read_points("near_sensors", keys.read(spec.near_sensors), spec.dimension == 3))
    views.push_back(near_sensor(point));
  return views;
}

void no_repeats(const std::string& key, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto twice = std::adjacent_find(values.begin(), values.end());
  if (twice != values.end()) throw InputError(key, *twice, "is given twice");
}

/// Throws InputError if far views repeat.
std::vector<View> distinct(std::vector<View> views) {
  auto sorted = views;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end() && !twice->near)
    throw InputError("view_angles", twice->angle, "is given twice");
  return views;
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
  const Light light = plane_waves(keys, spec).front();
  return memory_effect_request(2 * std::numbers::pi / spec.outside_wavelength(), light,
                               distinct(requested_views(keys, spec)), spec.tilts,
                               tilt_azimuth(keys, spec, light));
}

/// Checks that a list of tilts or shifts contains the value 0, and no value twice. The value 0 is
/// the reference, from which the range of a correlation is measured.
void steps_from_zero(const std::string& key, const std::vector<double>& steps) {
  no_repeats(key, steps);
  if (std::find(steps.begin(), steps.end(), 0.0) == steps.end())
    throw InputError(key, steps.front(), "the list must contain 0, the reference");
}

CovarianceRequest tilt_shift(const Keys& keys, const SceneSpec& spec) {
  const Light light = only_light(keys, spec);
  if (light.kind == Light::Kind::point)
    throw InputError("near_sources", spec.near_sources,
                     "a point source has no direction to tilt: use covariance = translation");
  steps_from_zero("tilts", at_least_one(keys, spec.tilts));
  steps_from_zero("shifts", at_least_one(keys, spec.shifts));
  return tilt_shift_request(2 * std::numbers::pi / spec.outside_wavelength(), light,
                            distinct(requested_views(keys, spec)), spec.tilts, spec.shifts,
                            tilt_azimuth(keys, spec, light));
}

CovarianceRequest translation(const Keys& keys, const SceneSpec& spec) {
  const Light light = only_light(keys, spec);
  if (light.kind == Light::Kind::plane)
    throw InputError("covariance", "translation",
                     "requires a beam or a near source; for a plane wave use tilt_shift");
  steps_from_zero("shifts", at_least_one(keys, spec.shifts));
  return translation_request(light, distinct(requested_views(keys, spec)), spec.shifts,
                             tilt_azimuth(keys, spec, light));
}

CovarianceRequest angle_pairs(const Keys& keys, const SceneSpec& spec) {
  const auto& angles = at_least_one(keys, spec.pairs);
  const bool in_space = spec.dimension == 3 && !keys.read(spec.pair_azimuths).empty();
  if (in_space && spec.pair_azimuths.size() != angles.size())
    throw InputError(
        "pair_azimuths", spec.pair_azimuths.size(),
        "azimuths: must be as many as the numbers of pairs, " + std::to_string(angles.size()));
  const auto azimuths_from = [&](std::size_t i) {
    std::array<double, 4> four{};
    if (in_space)
      std::copy_n(spec.pair_azimuths.begin() + static_cast<std::ptrdiff_t>(i), 4, four.begin());
    return four;
  };
  std::vector<AnglePair> pairs;
  for (std::size_t i = 0; i < angles.size(); i += 4)
    pairs.push_back({angles[i], angles[i + 1], angles[i + 2], angles[i + 3], azimuths_from(i)});
  return pairs_request(pairs);
}

}  // namespace

namespace {

CovarianceRequest request_of(const Keys& keys, const SceneSpec& spec) {
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

}  // namespace

CovarianceRequest make_request(const Keys& keys, const SceneSpec& spec) {
  CovarianceRequest request = request_of(keys, spec);
  if (!spec.view_angles.empty() && spec.near_sensors.empty()) request.camera = camera(keys, spec);
  return request;
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
    return request.lights[c.light].direction() - request.views[c.view].direction();
  };
  for (const auto& entry : request.entries) {
    const Vec change = momentum(request.channels[entry.a]) - momentum(request.channels[entry.b]);
    if (std::max(std::abs(change.x), std::abs(change.y)) > tolerance)
      throw InputError(
          "covariance: on an infinite slab only pairs with sin(light) - sin(view) unchanged "
          "correlate (the others are exactly 0); use intensity or memory_effect, or a box");
  }
}

}  // namespace flatspeckle

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "flatland/scene/scene.h"
#include "flatland/scene/scene_checks.h"

namespace flatspeckle {

namespace {

std::vector<View> far_views(const std::vector<double>& angles) {
  std::vector<View> views;
  for (double angle : angles) views.push_back(far_view(angle));
  return views;
}

std::vector<View> requested_views(const SceneSpec& spec) {
  auto views = far_views(spec.view_angles);
  if (!spec.near_sensors.empty())
    for (const Vec2& point : read_points(spec.near_sensors)) views.push_back(near_sensor(point));
  return views;
}

Lights near_lights(const SceneSpec& spec) {
  if (spec.beam_waist)
    throw InputError("beam_waist", *spec.beam_waist, "give either near_sources or beams");
  Lights lights;
  for (const Vec2& point : read_points(spec.near_sources)) lights.push_back(point_source(point));
  return lights;
}

/// All angles with all positions of the focus.
Lights beams(const SceneSpec& spec) {
  const double waist = positive("beam_waist", *spec.beam_waist);
  if (waist < spec.wavelength)
    throw InputError("beam_waist", waist, "a paraxial beam is at least a wavelength wide");
  auto positions = spec.beam_positions;
  if (positions.empty()) positions = {0};
  all_finite("beam_positions", positions);
  const double depth = spec.beam_depth.value_or(0);
  all_finite("beam_depth", {depth});
  Lights lights;
  for (double angle : spec.light_angles)
    for (double x : positions) lights.push_back(gaussian_beam(angle, {x, depth}, waist));
  return lights;
}

Lights requested_lights(const SceneSpec& spec) {
  if (!spec.beam_waist) {
    only_for("beam_depth", spec.beam_depth, false, "beams (beam_waist)");
    if (!spec.beam_positions.empty())
      throw InputError("beam_positions", spec.beam_positions.front(),
                       "is a key of beams (beam_waist) only");
  }
  if (!spec.near_sources.empty()) return near_lights(spec);
  if (spec.beam_waist) return beams(spec);
  return spec.light_angles;
}

Light only_light(const SceneSpec& spec) {
  const Lights lights = requested_lights(spec);
  if (lights.size() != 1)
    throw InputError("covariance", spec.covariance,
                     "moves one light, not " + std::to_string(lights.size()));
  return lights.front();
}

CovarianceRequest memory_effect(const SceneSpec& spec) {
  if (spec.light_angles.size() != 1)
    throw InputError("light_angles", spec.light_angles.size(),
                     "memory_effect tilts one light: give one angle");
  if (!requested_lights(spec).all(Light::Kind::plane))
    throw InputError(
        "covariance", "memory_effect",
        "tilts a plane wave: use tilt_shift for a beam, translation for a near source");
  if (!spec.near_sensors.empty())
    throw InputError("near_sensors", spec.near_sensors, "memory_effect has far views only");
  not_empty("tilts", spec.tilts);
  no_repeats("tilts", spec.tilts);
  not_empty("view_angles", spec.view_angles);
  no_repeats("view_angles", spec.view_angles);
  return memory_effect_request(2 * std::numbers::pi / spec.wavelength, spec.light_angles[0],
                               spec.view_angles, spec.tilts);
}

/// A range counts from the reference, which therefore is one of the steps.
void steps_from_zero(const std::string& key, const std::vector<double>& steps) {
  not_empty(key, steps);
  all_finite(key, steps);
  no_repeats(key, steps);
  if (std::find(steps.begin(), steps.end(), 0.0) == steps.end())
    throw InputError(key, steps.front(), "the list must hold 0, the reference, too");
}

std::vector<View> moved_views(const SceneSpec& spec) {
  auto views = requested_views(spec);
  if (views.empty()) throw InputError("view_angles = []: must hold at least one number");
  no_repeats("view_angles", spec.view_angles);
  return views;
}

CovarianceRequest tilt_shift(const SceneSpec& spec) {
  const Light light = only_light(spec);
  if (light.kind == Light::Kind::point)
    throw InputError("near_sources", spec.near_sources,
                     "a point source has no direction to tilt: use covariance = translation");
  steps_from_zero("tilts", spec.tilts);
  steps_from_zero("shifts", spec.shifts);
  return tilt_shift_request(2 * std::numbers::pi / spec.wavelength, light, moved_views(spec),
                            spec.tilts, spec.shifts);
}

CovarianceRequest translation(const SceneSpec& spec) {
  const Light light = only_light(spec);
  if (light.kind == Light::Kind::plane)
    throw InputError("covariance", "translation",
                     "moves a beam or a near source; for a plane wave use tilt_shift");
  steps_from_zero("shifts", spec.shifts);
  return translation_request(light, moved_views(spec), spec.shifts);
}

CovarianceRequest angle_pairs(const SceneSpec& spec) {
  not_empty("pairs", spec.pairs);
  all_radians("pairs", spec.pairs);
  if (spec.pairs.size() % 4 != 0)
    throw InputError("pairs", spec.pairs.size(),
                     "numbers; must be light 1, view 1, light 2, view 2 of each pair in turn");
  std::vector<AnglePair> pairs;
  for (std::size_t i = 0; i < spec.pairs.size(); i += 4)
    pairs.push_back({spec.pairs[i], spec.pairs[i + 1], spec.pairs[i + 2], spec.pairs[i + 3]});
  return pairs_request(pairs);
}

void check_move_keys(const SceneSpec& spec, CovarianceRequest::Kind kind) {
  using Request = CovarianceRequest::Kind;
  if (!spec.tilts.empty() && kind != Request::memory_effect && kind != Request::tilt_shift)
    throw InputError("tilts", spec.tilts.front(),
                     "is a key of covariance = memory_effect and tilt_shift only");
  if (!spec.shifts.empty() && kind != Request::tilt_shift && kind != Request::translation)
    throw InputError("shifts", spec.shifts.front(),
                     "is a key of covariance = tilt_shift and translation only");
}

}  // namespace

CovarianceRequest make_request(const SceneSpec& spec) {
  not_empty("light_angles", spec.light_angles);
  all_radians("light_angles", spec.light_angles);
  all_radians("view_angles", spec.view_angles);
  all_radians("tilts", spec.tilts);
  using Request = CovarianceRequest::Kind;
  const auto kind = choose<Request>("covariance", spec.covariance,
                                    {{"intensity", Request::intensity},
                                     {"pairs", Request::pairs},
                                     {"memory_effect", Request::memory_effect},
                                     {"tilt_shift", Request::tilt_shift},
                                     {"translation", Request::translation},
                                     {"full", Request::full}});
  check_move_keys(spec, kind);
  if (!spec.pairs.empty() && kind != Request::pairs)
    throw InputError("pairs", spec.pairs.front(), "is a key of covariance = pairs only");
  if (kind == Request::memory_effect) return memory_effect(spec);
  if (kind == Request::tilt_shift) return tilt_shift(spec);
  if (kind == Request::translation) return translation(spec);
  if (kind == Request::pairs) return angle_pairs(spec);
  const auto views = requested_views(spec);
  if (views.empty()) throw InputError("view_angles = []: must hold at least one number");
  if (kind == Request::full) return full_request(requested_lights(spec), views);
  return intensity_request(requested_lights(spec), views);
}

void check_slab_request(const CovarianceRequest& request) {
  if (!request.lights.all(Light::Kind::plane))
    throw InputError("near_sources, beam_waist: a slab has plane waves only; take a box");
  for (const Light& light : request.lights)
    if (std::cos(light.angle) <= 0)
      throw InputError("light_angles", light.angle, "light enters a slab at z = 0: |angle| < pi/2");
  for (const auto& view : request.views)
    if (view.near) throw InputError("near_sensors: a slab has far views only");
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

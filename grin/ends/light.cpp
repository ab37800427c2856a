#include "grin/ends/light.h"

#include <cmath>
#include <numbers>

#include "grin/fields/input_checks.h"
#include "grin/media/start_directions.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

/// Of n^2 over a patch: exact where n is constant.
double mean_index_squared(const BoundaryPatch& patch, const std::optional<Surface>& body,
                          const Lights::Index& index) {
  constexpr int points = 4096;
  RandomStream random(0, 0, 0);
  double mean = 0;
  for (int i = 0; i < points; ++i) {
    const Vec3 x = patch.sample(random).x;
    const double n = index({x, part_at(body, x)});
    mean += (n * n - mean) / (i + 1);
  }
  return mean;
}

/// Within what sums of squares can hold.
void require_brightness(const char* key, double value) {
  if (!(value >= 1e-50 && value <= 1e50))
    throw InputError(key, value, "must be from 1e-50 to 1e50");
}

/// The disk has no point outside the stage, as far as its rim tells, and light goes into it.
void require_inside(const BeamLight& beam, const FlatDisk& disk, const Stage& stage) {
  constexpr int rim_points = 64;
  const double tolerance = 1e-9 * (beam.radius + std::abs(distance(stage.boundary, beam.centre)));
  for (int i = 0; i < rim_points; ++i)
    if (!(distance(stage.boundary, disk.rim(2 * pi * i / rim_points)) <= tolerance))
      throw InputError("beam_light, radius", beam.radius,
                       "the beam's disk must be inside the stage");
  if (distance(stage.boundary, beam.centre) >= -tolerance &&
      !(beam.direction.dot(normal(stage.boundary, beam.centre)) < 0))
    throw InputError("beam_light, direction", listed(beam.direction), "must point into the stage");
}

}  // namespace

Lights::Source Lights::source(const PointLight& light, const Stage& stage, const Index&) {
  require_finite("point_light, position", light.x);
  require_brightness("point_light, power", light.power);
  if (!(distance(stage.boundary, light.x) < 0))
    throw InputError("point_light, position", listed(light.x), "must be inside the stage");
  return {.light = light, .power = light.power};
}

Lights::Source Lights::source(const BeamLight& light, const Stage& stage, const Index&) {
  BeamLight beam = light;
  beam.direction = unit_direction("beam_light, direction", light.direction);
  require_finite("beam_light, position", beam.centre);
  require_positive("beam_light, radius", beam.radius);
  require_brightness("beam_light, power", beam.power);
  const FlatDisk disk(beam.centre, beam.direction, beam.radius);
  require_inside(beam, disk, stage);
  return {.light = beam,
          .power = beam.power,
          .position_density = 1 / (pi * beam.radius * beam.radius),
          .disk = disk};
}

Lights::Source Lights::source(const FaceLight& light, const Stage& stage, const Index& index) {
  const bool everywhere = light.radius == INFINITY;
  require_brightness(everywhere ? "environment" : "face_light, radiance", light.radiance);
  if (!everywhere) require_finite("face_light, position", light.centre);
  BoundaryPatch patch = everywhere ? BoundaryPatch(stage.boundary, "environment")
                                   : BoundaryPatch(stage.boundary, light.centre, light.radius,
                                                   "face_light, position", "face_light, radius");
  const double n_squared = mean_index_squared(patch, body_surface(stage), index);
  if (!(n_squared > 0 && std::isfinite(n_squared)))
    throw InputError("face_light: the index of refraction is not positive and finite all over it");
  return {.light = light,
          .power = pi * n_squared * patch.area() * light.radiance,
          .position_density = 1 / patch.area(),
          .patch = patch};
}

Lights::Lights(std::vector<Light> lights, const Stage& stage, const Index& index)
    : body_(body_surface(stage)) {
  if (lights.empty()) throw InputError("light: the scene needs at least one");
  for (const Light& light : lights) {
    source_.push_back(std::visit([&](const auto& l) { return source(l, stage, index); }, light));
    if (source_.back().patch) faces_.push_back(static_cast<int>(source_.size()) - 1);
    power_ += source_.back().power;
    if (source_.back().disk) {
      beams_.push_back(static_cast<int>(source_.size()) - 1);
      beam_power_ += source_.back().power;
    }
  }
  double so_far = 0;
  for (Source& s : source_) {
    s.chance = s.power / power_;
    s.position_density *= s.chance;
    if (!(s.position_density > 0 && std::isfinite(s.position_density)))
      throw InputError("light", &s - source_.data() + 1,
                       "has a size or a share of the power too small or too large for numbers");
    so_far += s.chance;
    s.chance_so_far = so_far;
  }
}

EndPosition Lights::position(int light, const BoundaryPoint& at) const {
  return {.point = {at.x, part_at(body_, at.x)},
          .inward = at.inward,
          .position_density = source_[light].position_density,
          .light = light};
}

EndPosition Lights::on_beam(int beam, const Vec3& x) const {
  EndPosition at = position(beam, {x, source_[beam].disk->normal()});
  at.is_beam = true;
  return at;
}

EndPosition Lights::beam_position(double stratum, double u, double v) const {
  double power = stratum * beam_power_;
  std::size_t i = 0;
  while (i + 1 < beams_.size() && power >= source_[beams_[i]].power)
    power -= source_[beams_[i++]].power;
  return on_beam(beams_[i], source_[beams_[i]].disk->from_square(u, v));
}

EndPosition Lights::draw_position(RandomStream& random) const {
  const double u = random.uniform();
  int light = 0;
  while (light + 1 < static_cast<int>(source_.size()) && u >= source_[light].chance_so_far) ++light;
  const Source& from = source_[light];
  if (from.patch) return position(light, from.patch->sample(random));
  if (from.disk) return on_beam(light, from.disk->sample(random));
  EndPosition at = position(light, {std::get<PointLight>(from.light).x, Vec3::Zero()});
  at.is_point = true;
  return at;
}

EndDirection Lights::sample_direction(const EndPosition& at, RandomStream& random) const {
  const Source& from = source_[at.light];
  if (at.is_beam)
    return {.direction = at.inward,
            .density = 1,
            .strength = from.power * from.position_density / from.chance};
  const double u = random.uniform();
  if (at.is_point) return towards(at, random_turn(Vec3::UnitZ(), 2 * u, random));
  return towards(at, random_turn(at.inward, 1 - std::sqrt(u), random));
}

EndDirection Lights::towards(const EndPosition& at, const Vec3& direction) const {
  const Source& from = source_[at.light];
  EndDirection to{.direction = direction};
  if (at.is_point) {
    to.density = 1 / (4 * pi);
    to.strength = from.power / (4 * pi);
  } else if (!at.is_beam) {
    const double cosine = std::max(0.0, direction.dot(at.inward));
    to.density = cosine / pi;
    to.strength = at.index * at.index * cosine * std::get<FaceLight>(from.light).radiance;
  }
  return to;
}

}  // namespace flatspeckle::grin

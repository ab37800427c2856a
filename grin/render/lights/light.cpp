#include "grin/render/lights/light.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::grin {

namespace {

template <class... Kind>
void add_all(Keys& keys, LightKinds<Kind...>& values) {
  (add_keys(keys, static_cast<Kind&>(values)), ...);
}

template <class... Kind>
std::vector<Light> make_all(const Keys& keys, const LightKinds<Kind...>& values) {
  std::vector<Light> lights;
  const auto append = [&](const auto& more) {
    lights.insert(lights.end(), more.begin(), more.end());
  };
  (append(make_lights(keys, static_cast<const Kind&>(values))), ...);
  return lights;
}

LightValues::End end_of(const Light& light, const Stage& stage, const IndexAt& index) {
  return std::visit(
      [&]<class L>(const L& of) -> LightValues::End { return typename L::End(of, stage, index); },
      light);
}

}  // namespace

void add_keys(Keys& keys, LightValues& values) {
  keys.group("Lights of the stage");
  add_all(keys, values);
}

std::vector<Light> make_lights(const Keys& keys, const LightValues& values) {
  return make_all(keys, values);
}

StageLights::StageLights(const std::vector<Light>& lights, const Stage& stage, const IndexAt& index)
    : regions_(stage) {
  if (lights.empty())
    throw InputError(
        "light is not given: a scene requires one or more of point_light, beam_light, "
        "gaussian_beam, "
        "fibre_light, gaussian_fibre, face_light, environment");
  for (const Light& light : lights) {
    const auto number = static_cast<int>(source_.size());
    auto end = end_of(light, stage, index);
    const auto power_of = [](const auto& of) { return of.power(); };
    const double power = std::visit(power_of, end);
    power_ += power;
    if (std::holds_alternative<FaceLightEnd>(end)) faces_.push_back(number);
    if (std::holds_alternative<BeamLightEnd>(end)) {
      beams_.push_back(number);
      beam_power_ += power;
    }
    source_.push_back({std::move(end), power});
  }
  settle_probabilities();
}

void StageLights::settle_probabilities() {
  const auto some_density = [](const auto& end) {
    RandomStream random(0, 0, 0);
    return end.density(end.sample(random).x);
  };
  double so_far = 0;
  for (Source& s : source_) {
    s.probability = s.power / power_;
    const double density = s.probability * std::visit(some_density, s.end);
    if (!(density > 0 && std::isfinite(density)))
      throw InputError(
          "light", &s - source_.data() + 1,
          "must have a size and a share of the total power that double precision can represent");
    so_far += s.probability;
    s.probability_so_far = so_far;
  }
}

EndPosition StageLights::position(int light, const BoundaryPoint& at) const {
  return std::visit(
      [&](const auto& end) {
        EndPosition position{.point = {at.x, regions_.at(at.x)},
                             .inward = at.inward,
                             .position_density = source_[light].probability * end.density(at.x),
                             .light = light,
                             .is_point = end.is_point,
                             .is_beam = end.is_beam};
        if constexpr (requires { end.surrounds(); }) position.surrounds = end.surrounds();
        return position;
      },
      source_[light].end);
}

StageLights::PlaceInBeam StageLights::beam_place(double stratum) const {
  double power = stratum * beam_power_;
  std::size_t i = 0;
  while (i + 1 < beams_.size() && power >= source_[beams_[i]].power)
    power -= source_[beams_[i++]].power;
  return {i, std::min(power / source_[beams_[i]].power, 1.0)};
}

StageLights::Beam StageLights::beam_at(std::size_t number) const {
  return {number, std::get<BeamLightEnd>(source_[beams_[number]].end).disk(), beam_power_};
}

StageLights::Beam StageLights::beam_of(const EndPosition& at) const {
  const auto number = std::find(beams_.begin(), beams_.end(), at.light) - beams_.begin();
  return beam_at(static_cast<std::size_t>(number));
}

EndPosition StageLights::beam_position(double stratum, double u, double v) const {
  return position_on(beam_place(stratum).number, u, v);
}

EndPosition StageLights::beam_position(double stratum, double v) const {
  const PlaceInBeam place = beam_place(stratum);
  return position_on(place.number, place.u, v);
}

EndPosition StageLights::position_on(std::size_t beam, double u, double v) const {
  return position(beams_[beam], beam_at(beam).disk.from_square(u, v));
}

EndPosition StageLights::draw_position(RandomStream& random) const {
  const double u = source_.size() > 1 ? random.uniform() : 0;
  int light = 0;
  while (light + 1 < static_cast<int>(source_.size()) && u >= source_[light].probability_so_far)
    ++light;
  return position(
      light, std::visit([&](const auto& end) { return end.sample(random); }, source_[light].end));
}

EndDirection StageLights::sample_direction(const EndPosition& at, RandomStream& random) const {
  const Source& from = source_[at.light];
  EndDirection to =
      std::visit([&](const auto& end) { return end.sample_direction(at, random); }, from.end);
  // position_density, by which the strength of a beam was computed, contains the light's
  // probability
  if (at.is_beam) to.strength /= from.probability;
  return to;
}

EmissionChange StageLights::by_index(const EndPosition& at, const Vec3& direction) const {
  return std::visit([&](const auto& end) { return end.by_index(at, direction); },
                    source_[at.light].end);
}

bool StageLights::aim(const Aim& at) {
  bool is_any = false;
  for (const int light : faces_) {
    auto& face = std::get<FaceLightEnd>(source_[light].end);
    if (face.surrounds()) continue;
    face.aim(at);
    is_any = true;
  }
  return is_any;
}

EndDirection StageLights::towards(const EndPosition& at, const Vec3& direction) const {
  return std::visit([&](const auto& end) { return end.towards(at, direction); },
                    source_[at.light].end);
}

}  // namespace flatspeckle::grin

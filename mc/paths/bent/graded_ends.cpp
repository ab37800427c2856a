#include "mc/paths/bent/graded_ends.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/phasor.h"

namespace flatspeckle::mc {

namespace {

constexpr double log_of_no_light = -1e4;  ///< exp of it is 0
constexpr double apart_enough = 10;       ///< k S, for the far-field form

std::shared_ptr<const Wavefront> wave_from(const End& end, const GradedMedium& medium) {
  if (end.near) return medium.from_point(end.point);
  return medium.from_afar(angle_of(-end.towards));
}

}  // namespace

GradedEnds::GradedEnds(const Scene& scene, const std::vector<End>& ends, bool phases,
                       const GradedMedium& medium)
    : EndFactors(ends.size()),
      k_(scene.k),
      mu_t_(scene.medium.mu_t),
      phases_(phases),
      phase_(ends.size()),
      log_magnitude_(ends.size()) {
  for (const End& end : ends) ends_.push_back({wave_from(end, medium), end.near, end.strength});
}

void GradedEnds::attenuate(Vec2 x, std::span<Complex> out) {
  for (std::size_t j = 0; j < size(); ++j) {
    const auto arrival = ends_[j].wave->at(x);
    if (!arrival) {
      directions_.set(j, {0, 1}, 0);
      phase_[j] = 0;
      log_attenuation_[j] = log_magnitude_[j] = log_of_no_light;
      continue;
    }
    const Vec2 w = -arrival->w;
    directions_.set(j, w, angle_of(w));
    phase_[j] = k_ * arrival->path;
    log_attenuation_[j] = -mu_t_ * arrival->inside / 2;
    log_magnitude_[j] =
        std::max(std::log(arrival->amplitude) + log_attenuation_[j], log_of_no_light);
  }
  damped_phasors(phase_, log_magnitude_, out);
  for (std::size_t j = 0; j < size(); ++j) {
    if (!ends_[j].near) {
      if (!phases_) out[j] = std::abs(out[j]);
      continue;
    }
    if (phase_[j] < apart_enough && log_magnitude_[j] > log_of_no_light) {
      const double path = std::max(phase_[j] / k_, 1e-200);
      out[j] = std::exp(log_magnitude_[j]) * std::sqrt(path) * outgoing_wave(k_, path);
    }
    out[j] = product(out[j], ends_[j].strength);
    if (!phases_) out[j] = std::abs(out[j]);
  }
}

namespace {

std::string text_of(Vec2 place) {
  return '(' + number_text(place.x) + ", " + number_text(place.z) + ')';
}

}  // namespace

void require_one_ray(const Scene& scene, const Wavefront& wave, const std::string& whose) {
  Domain domain = scene.domain;
  if (domain.kind == Domain::Kind::slab) domain.width = 0;
  constexpr std::size_t per_side = 64;
  for (const Vec2 place : edge_places(domain, per_side))
    if (!wave.at(place))
      throw InputError("index_field: light of " + whose + " does not come to " + text_of(place) +
                       " of the medium before a caustic; take a weaker field, a smaller box or "
                       "other ends");
}

void check_graded_ends(const Scene& scene, const GradedMedium& medium) {
  const auto name = [](const End& end) {
    return end.near ? text_of(end.point) : "direction " + number_text(angle_of(end.towards));
  };
  for (const auto& ends : {light_ends(scene), view_ends(scene)})
    for (const End& end : ends) require_one_ray(scene, *wave_from(end, medium), name(end));
}

}  // namespace flatspeckle::mc

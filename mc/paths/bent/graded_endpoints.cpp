#include "mc/paths/bent/graded_endpoints.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/phasor.h"

namespace flatspeckle::mc {

namespace {

constexpr double log_of_no_light = -1e4;  ///< a value whose exp is 0
/// Phase k S, S the optical path, above which the far-field form of a point's wave is used
constexpr double apart_enough = 10;

std::shared_ptr<const Wavefront> wave_from(const Endpoint& end, const GradedMedium& medium) {
  if (end.near) return medium.from_point(end.point);
  return medium.from_afar(angle_of(-end.towards));
}

}  // namespace

GradedEndpoints::GradedEndpoints(const Scene& scene, const std::vector<Endpoint>& endpoints,
                                 bool phases, const GradedMedium& medium)
    : EndpointFactors(endpoints.size()),
      k_(scene.k),
      mu_t_(scene.medium.mu_t),
      phases_(phases),
      phase_(endpoints.size()),
      log_magnitude_(endpoints.size()) {
  for (const Endpoint& end : endpoints)
    endpoints_.push_back({wave_from(end, medium), end.near, end.strength});
}

void GradedEndpoints::attenuate(Vec x, std::span<Complex> out) {
  for (std::size_t j = 0; j < size(); ++j) {
    const auto arrival = endpoints_[j].wave->at(x);
    if (!arrival) {
      directions_.set(j, {0, 1});
      phase_[j] = 0;
      log_attenuation_[j] = log_magnitude_[j] = log_of_no_light;
      continue;
    }
    const Vec w = -arrival->w;
    directions_.set(j, w);
    phase_[j] = k_ * arrival->path;
    log_attenuation_[j] = -mu_t_ * arrival->inside / 2;
    log_magnitude_[j] =
        std::max(std::log(arrival->amplitude) + log_attenuation_[j], log_of_no_light);
  }
  damped_phasors(phase_, log_magnitude_, out);
  for (std::size_t j = 0; j < size(); ++j) {
    if (!endpoints_[j].near) {
      if (!phases_) out[j] = std::abs(out[j]);
      continue;
    }
    if (phase_[j] < apart_enough && log_magnitude_[j] > log_of_no_light) {
      const double path = std::max(phase_[j] / k_, 1e-200);
      out[j] = std::exp(log_magnitude_[j]) * std::sqrt(path) * outgoing_wave(k_, path);
    }
    out[j] = product(out[j], endpoints_[j].strength);
    if (!phases_) out[j] = std::abs(out[j]);
  }
}

namespace {

std::string text_of(Vec place) {
  return '(' + number_text(place.x) + ", " + number_text(place.z) + ')';
}

}  // namespace

void require_one_ray(const Scene& scene, const Wavefront& wave, const std::string& whose) {
  Domain domain = scene.domain;
  if (domain.kind == Domain::Kind::slab) domain.width = 0;
  constexpr std::size_t per_side = 64;
  for (const Vec place : edge_places(domain, per_side))
    if (!wave.at(place))
      throw InputError("index_field: light of " + whose + " does not reach " + text_of(place) +
                       " in the medium by a ray without a caustic; take a weaker field, a smaller "
                       "box or other endpoints");
}

void check_graded_endpoints(const Scene& scene, const GradedMedium& medium) {
  const auto name = [](const Endpoint& end) {
    return end.near ? text_of(end.point) : "direction " + number_text(angle_of(end.towards));
  };
  for (const auto& endpoints : {light_endpoints(scene), view_endpoints(scene)})
    for (const Endpoint& end : endpoints)
      require_one_ray(scene, *wave_from(end, medium), name(end));
}

}  // namespace flatspeckle::mc

#include "mc/paths/endpoint_factors/endpoint_factors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/phasor.h"

namespace flatspeckle::mc {

namespace {

/// A logarithm whose exp is 0. It is finite, because the vectorised exp is accurate only for finite
/// arguments.
constexpr double log_of_nothing = -1e4;
constexpr double never = 1e300;  ///< a position further away than any edge

/// Makes the endpoint of a light. The field of a point source is the Green function: exp(i pi/4) /
/// sqrt(8 pi k) outgoing_wave() or, in space, exp(i k r) / (4 pi r).
Endpoint endpoint_of(const Light& light, double k, int dimension) {
  switch (light.kind) {
    case Light::Kind::plane:
      break;
    case Light::Kind::point:
      return {true,
              {0, 1},
              light.point,
              dimension == 3
                  ? 1 / (4 * std::numbers::pi)
                  : std::polar(1 / std::sqrt(8 * std::numbers::pi * k), std::numbers::pi / 4),
              {}};
    case Light::Kind::beam:
      return {true, -light.direction(), light.point, 1, GaussianBeam(light, k, dimension)};
  }
  return {false, -light.direction(), {}, 1, {}};
}

constexpr double far_enough = 10;  ///< k r above which the far-field form is used

}  // namespace

Complex outgoing_wave(double k, double r) {
  if (k * r > far_enough) return std::polar(1 / std::sqrt(r), k * r);
  const Complex turn = std::polar(std::sqrt(std::numbers::pi * k / 2), std::numbers::pi / 4);
  return turn * Complex(::j0(k * r), ::y0(k * r));
}

std::vector<Endpoint> light_endpoints(const Scene& scene) {
  std::vector<Endpoint> endpoints;
  for (const Light& light : scene.request.lights)
    endpoints.push_back(endpoint_of(light, scene.k, scene.medium.dimension));
  return endpoints;
}

std::vector<Endpoint> view_endpoints(const Scene& scene) {
  std::vector<Endpoint> endpoints;
  for (const View& view : scene.request.views)
    endpoints.push_back({view.near, view.direction(), view.point, 1, {}});
  return endpoints;
}

StraightEndpoints::StraightEndpoints(const Scene& scene, const std::vector<Endpoint>& endpoints,
                                     bool phases)
    : EndpointFactors(endpoints.size()),
      domain_(scene.domain),
      k_(scene.k),
      phases_(phases),
      in_space_(scene.medium.dimension == 3),
      extinction_(scene) {
  const bool box = domain_.kind == Domain::Kind::box;
  for (std::size_t j = 0; j < endpoints.size(); ++j) {
    const Vec w = endpoints[j].towards;
    if (endpoints[j].beam)
      beams_.push_back({j, *endpoints[j].beam});
    else if (endpoints[j].near)
      points_.push_back({j, endpoints[j].point, endpoints[j].strength});
    directions_.set(j, w);
    edge_x_.add(box ? w.x : 0, -domain_.width / 2, domain_.width / 2);
    edge_y_.add(box ? w.y : 0, -domain_.height / 2, domain_.height / 2);
    edge_z_.add(w.z, 0, domain_.depth);
  }
  phase_.resize(size());
  magnitude_.resize(size());
  point_r_.resize(points_.size());
  point_phase_.resize(points_.size());
  point_log_.resize(points_.size());
  point_wave_.resize(points_.size());
}

void StraightEndpoints::Edges::add(double w, double low, double high) {
  const bool crosses = std::abs(w) >= 1e-300;
  position.push_back(!crosses ? never : w > 0 ? high : low);
  per_cosine.push_back(crosses ? 1 / w : 1);
}

double StraightEndpoints::log_magnitude(Vec x, Vec w, double inside) const {
  return std::max(-extinction_.optical_depth(x, w, inside) / 2, log_of_nothing);
}

void StraightEndpoints::attenuate(Vec x, std::span<Complex> out) {
  in_space_ ? attenuate_far<true>(x) : attenuate_far<false>(x);
  if (phases_) {
    damped_phasors(phase_, log_attenuation_, out);
  } else {
    damping(log_attenuation_, magnitude_);
    std::copy(magnitude_.begin(), magnitude_.end(), out.begin());
  }
  if (!points_.empty()) attenuate_points(x, out);
  if (!beams_.empty()) attenuate_beams(x, out);
}

/// Computes the logarithms of the attenuations and the phases of all endpoints as if they were far.
template <bool in_space>
void StraightEndpoints::attenuate_far(Vec x) {
  if (extinction_.profile == nullptr) {
    for (std::size_t j = 0; j < size(); ++j)
      log_attenuation_[j] =
          std::max(-extinction_.mu_t * distance_to_edge<in_space>(j, x) / 2, log_of_nothing);
  } else {
    for (std::size_t j = 0; j < size(); ++j)
      log_attenuation_[j] = log_magnitude(x, directions_[j], distance_to_edge<in_space>(j, x));
  }
  if (!phases_) return;
  for (std::size_t j = 0; j < size(); ++j) {
    double along = directions_.x[j] * x.x + directions_.z[j] * x.z;
    if constexpr (in_space) along += directions_.y[j] * x.y;
    phase_[j] = -k_ * along;
  }
}

void StraightEndpoints::attenuate_points(Vec x, std::span<Complex> out) {
  constexpr double closest = 1e-200;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec offset = points_[i].point - x;
    const double r = std::max(length(offset), closest);
    const Vec w = 1 / r * offset;
    directions_.set(points_[i].number, w);
    point_r_[i] = r;
    point_phase_[i] = k_ * r;
    const double inside = std::min(domain_.distance_to_edge(x, w), r);
    point_log_[i] = log_magnitude(x, w, inside);
    log_attenuation_[points_[i].number] = point_log_[i];
  }
  damped_phasors(point_phase_, point_log_, point_wave_);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Complex wave = in_space_ ? point_wave_[i] / point_r_[i]
                         : point_phase_[i] > far_enough
                             ? point_wave_[i] / std::sqrt(point_r_[i])
                             : std::exp(point_log_[i]) * outgoing_wave(k_, point_r_[i]);
    Complex& value = out[points_[i].number];
    value = product(points_[i].strength, wave);
    if (!phases_) value = std::abs(value);
  }
}

void StraightEndpoints::attenuate_beams(Vec x, std::span<Complex> out) {
  for (const auto& [j, beam] : beams_) {
    const Vec w = -beam.ray(x);
    directions_.set(j, w);
    log_attenuation_[j] = log_magnitude(x, w, domain_.distance_to_edge(x, w));
    out[j] = std::exp(log_attenuation_[j]) * beam.field(x);
    if (!phases_) out[j] = std::abs(out[j]);
  }
}

}  // namespace flatspeckle::mc

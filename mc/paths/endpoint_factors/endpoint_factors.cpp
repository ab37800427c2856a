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

/// Edge of the medium perpendicular to an axis. The distance along a ray from the coordinate x on
/// this axis to the edge is (position - x) per_cosine.
struct Edge {
  double position, per_cosine;
};
Edge edge_along(double w, double low, double high) {
  if (std::abs(w) < 1e-300) return {never, 1};
  return {w > 0 ? high : low, 1 / w};
}

/// Makes the endpoint of a light. The field of a point source is the Green function, exp(i pi/4) /
/// sqrt(8 pi k) outgoing_wave().
Endpoint endpoint_of(const Light& light, double k) {
  switch (light.kind) {
    case Light::Kind::plane:
      break;
    case Light::Kind::point:
      return {true,
              {0, 1},
              light.point,
              std::polar(1 / std::sqrt(8 * std::numbers::pi * k), std::numbers::pi / 4),
              {}};
    case Light::Kind::beam:
      return {true, -direction(light.angle), light.point, 1, GaussianBeam(light, k)};
  }
  return {false, -direction(light.angle), {}, 1, {}};
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
  for (const Light& light : scene.request.lights) endpoints.push_back(endpoint_of(light, scene.k));
  return endpoints;
}

std::vector<Endpoint> view_endpoints(const Scene& scene) {
  std::vector<Endpoint> endpoints;
  for (const View& view : scene.request.views)
    endpoints.push_back({view.near, direction(view.angle), view.point, 1, {}});
  return endpoints;
}

StraightEndpoints::StraightEndpoints(const Scene& scene, const std::vector<Endpoint>& endpoints,
                                     bool phases)
    : EndpointFactors(endpoints.size()),
      domain_(scene.domain),
      k_(scene.k),
      phases_(phases),
      extinction_(scene) {
  const bool box = domain_.kind == Domain::Kind::box;
  for (std::size_t j = 0; j < endpoints.size(); ++j) {
    const Vec2 w = endpoints[j].towards;
    if (endpoints[j].beam)
      beams_.push_back({j, *endpoints[j].beam});
    else if (endpoints[j].near)
      points_.push_back({j, endpoints[j].point, endpoints[j].strength});
    directions_.set(j, w, angle_of(w));
    const Edge across =
                   box ? edge_along(w.x, -domain_.width / 2, domain_.width / 2) : Edge{never, 1},
               deep = edge_along(w.z, 0, domain_.depth);
    edge_x_.push_back(across.position);
    per_cosine_x_.push_back(across.per_cosine);
    edge_z_.push_back(deep.position);
    per_cosine_z_.push_back(deep.per_cosine);
  }
  phase_.resize(size());
  magnitude_.resize(size());
  point_r_.resize(points_.size());
  point_phase_.resize(points_.size());
  point_log_.resize(points_.size());
  point_wave_.resize(points_.size());
}

double StraightEndpoints::log_magnitude(Vec2 x, Vec2 w, double inside) const {
  return std::max(-extinction_.optical_depth(x, w, inside) / 2, log_of_nothing);
}

void StraightEndpoints::attenuate(Vec2 x, std::span<Complex> out) {
  if (extinction_.profile == nullptr) {
    for (std::size_t j = 0; j < size(); ++j)
      log_attenuation_[j] =
          std::max(-extinction_.mu_t * distance_to_edge(j, x) / 2, log_of_nothing);
  } else {
    for (std::size_t j = 0; j < size(); ++j)
      log_attenuation_[j] = log_magnitude(x, directions_[j], distance_to_edge(j, x));
  }
  if (phases_) {
    for (std::size_t j = 0; j < size(); ++j)
      phase_[j] = -k_ * (directions_.x[j] * x.x + directions_.z[j] * x.z);
    damped_phasors(phase_, log_attenuation_, out);
  } else {
    damping(log_attenuation_, magnitude_);
    std::copy(magnitude_.begin(), magnitude_.end(), out.begin());
  }
  if (!points_.empty()) attenuate_points(x, out);
  if (!beams_.empty()) attenuate_beams(x, out);
}

void StraightEndpoints::attenuate_points(Vec2 x, std::span<Complex> out) {
  constexpr double closest = 1e-200;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec2 offset = points_[i].point - x;
    const double r = std::max(length(offset), closest);
    const Vec2 w = 1 / r * offset;
    directions_.set(points_[i].number, w, angle_of(w));
    point_r_[i] = r;
    point_phase_[i] = k_ * r;
    const double inside = std::min(domain_.distance_to_edge(x, w), r);
    point_log_[i] = log_magnitude(x, w, inside);
    log_attenuation_[points_[i].number] = point_log_[i];
  }
  damped_phasors(point_phase_, point_log_, point_wave_);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Complex wave = point_phase_[i] > far_enough
                             ? point_wave_[i] / std::sqrt(point_r_[i])
                             : std::exp(point_log_[i]) * outgoing_wave(k_, point_r_[i]);
    Complex& value = out[points_[i].number];
    value = product(points_[i].strength, wave);
    if (!phases_) value = std::abs(value);
  }
}

void StraightEndpoints::attenuate_beams(Vec2 x, std::span<Complex> out) {
  for (const auto& [j, beam] : beams_) {
    const Vec2 w = -beam.ray(x);
    directions_.set(j, w, angle_of(w));
    log_attenuation_[j] = log_magnitude(x, w, domain_.distance_to_edge(x, w));
    out[j] = std::exp(log_attenuation_[j]) * beam.field(x);
    if (!phases_) out[j] = std::abs(out[j]);
  }
}

}  // namespace flatspeckle::mc

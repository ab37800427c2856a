#include "mc/end_factors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/phasor.h"

namespace flatspeckle::mc {

namespace {

/// exp of it is 0, and finite arguments keep the vectorised exp honest.
constexpr double log_of_nothing = -1e4;
constexpr double never = 1e300;  ///< further than any edge

/// Distance to an edge along an axis = (position - x) per_cosine.
struct Edge {
  double position, per_cosine;
};
Edge edge_along(double w, double low, double high) {
  if (std::abs(w) < 1e-300) return {never, 1};
  return {w > 0 ? high : low, 1 / w};
}

}  // namespace

Complex outgoing_wave(double k, double r) {
  constexpr double far_enough = 10;
  if (k * r > far_enough) return std::polar(1 / std::sqrt(r), k * r);
  const Complex turn = std::polar(std::sqrt(std::numbers::pi * k / 2), std::numbers::pi / 4);
  return turn * Complex(::j0(k * r), ::y0(k * r));
}

std::vector<End> light_ends(const Scene& scene) {
  std::vector<End> ends;
  for (double angle : scene.request.lights) ends.push_back({false, -direction(angle), {}});
  return ends;
}

std::vector<End> view_ends(const Scene& scene) {
  std::vector<End> ends;
  for (const View& view : scene.request.views)
    ends.push_back({view.near, direction(view.angle), view.point});
  return ends;
}

template <bool near, bool phases>
EndFactors<near, phases>::EndFactors(const Scene& scene, const std::vector<End>& ends)
    : domain_(scene.domain), k_(scene.k), mu_t_(scene.medium.mu_t), directions_(ends.size()) {
  const bool box = domain_.kind == Domain::Kind::box;
  for (std::size_t j = 0; j < ends.size(); ++j) {
    const Vec2 w = ends[j].towards;
    if (ends[j].near) near_.push_back(j);
    points_.push_back(ends[j].point);
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
  log_magnitude_.resize(size());
  magnitude_.resize(size());
}

template <bool near, bool phases>
void EndFactors<near, phases>::attenuate(Vec2 x, std::span<Complex> out) {
  for (std::size_t j = 0; j < size(); ++j) {
    const double inside =
        std::min((edge_x_[j] - x.x) * per_cosine_x_[j], (edge_z_[j] - x.z) * per_cosine_z_[j]);
    log_magnitude_[j] = std::max(-mu_t_ * std::max(inside, 0.0) / 2, log_of_nothing);
  }
  if constexpr (phases) {
    for (std::size_t j = 0; j < size(); ++j)
      phase_[j] = -k_ * (directions_.x[j] * x.x + directions_.z[j] * x.z);
    damped_phasors(phase_, log_magnitude_, out);
  } else {
    damping(log_magnitude_, magnitude_);
    std::copy(magnitude_.begin(), magnitude_.end(), out.begin());
  }
  if constexpr (near) attenuate_near(x, out);
}

template <bool near, bool phases>
void EndFactors<near, phases>::attenuate_near(Vec2 x, std::span<Complex> out) {
  for (std::size_t j : near_) {
    const Vec2 way = points_[j] - x;
    const double r = length(way);
    const Vec2 w = 1 / r * way;
    directions_.set(j, w, angle_of(w));
    const double inside = std::min(domain_.distance_to_edge(x, w), r);
    log_magnitude_[j] = -mu_t_ * inside / 2;
    out[j] = std::exp(log_magnitude_[j]) * outgoing_wave(k_, r);
    if constexpr (!phases) out[j] = std::abs(out[j]);
  }
}

template class EndFactors<false, false>;
template class EndFactors<false, true>;
template class EndFactors<true, false>;
template class EndFactors<true, true>;

}  // namespace flatspeckle::mc

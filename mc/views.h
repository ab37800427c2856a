#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "core/phasor.h"
#include "flatland/scene.h"
#include "mc/lights.h"
#include "mc/scattering.h"

namespace flatspeckle::mc {

/// Field of a unit scatterer at distance r in the far-field form exp(ikr)/sqrt(r) (C4), by the
/// Hankel function itself where k r is small (C13).
inline Complex outgoing_wave(double k, double r) {
  constexpr double far_enough = 10;
  if (k * r > far_enough) return std::polar(1 / std::sqrt(r), k * r);
  const Complex turn = std::polar(std::sqrt(std::numbers::pi * k / 2), std::numbers::pi / 4);
  return turn * Complex(::j0(k * r), ::y0(k * r));
}

/// Where the light that leaves a scatterer is seen: the end factors e_v times the amplitude towards
/// the view (C13, C14). Near: some views are points.
template <bool near>
class Views {
 public:
  explicit Views(const Scene& scene)
      : domain_(scene.domain), k_(scene.k), mu_t_(scene.medium.mu_t), views_(scene.request.views) {
    for (const auto& view : views_) direction_.emplace_back(view.angle);
    phase_.resize(views_.size());
    log_magnitude_.resize(views_.size());
  }

  std::size_t size() const { return views_.size(); }

  /// out[v] = A(from -> v) e_v(x) of every view, for light that arrives at x along `from`.
  template <typename Scattering>
  void at(Vec2 x, const Direction& from, const Scattering& scattering, std::span<Complex> out) {
    attenuate(x, out);
    for (std::size_t v = 0; v < size(); ++v)
      out[v] = product(out[v], scattering.amplitude(from, towards(v, x)));
  }

  /// out[v] = e_v(x) alone.
  void attenuate(Vec2 x, std::span<Complex> out) {
    for (std::size_t v = 0; v < size(); ++v) {
      const Vec2 w = towards(v, x).w;
      double inside = domain_.distance_to_edge(x, w);
      if (near && views_[v].near) inside = std::min(inside, length(views_[v].point - x));
      phase_[v] = -k_ * dot(w, x);
      log_magnitude_[v] = std::max(-mu_t_ * inside / 2, log_of_nothing);
    }
    damped_phasors(phase_, log_magnitude_, out);
    if constexpr (near) {
      for (std::size_t v = 0; v < size(); ++v) {
        if (!views_[v].near) continue;
        out[v] = std::exp(log_magnitude_[v]) * outgoing_wave(k_, length(views_[v].point - x));
      }
    }
  }

  Direction towards(std::size_t v, Vec2 x) const {
    if constexpr (near) {
      if (views_[v].near) {
        const Vec2 way = views_[v].point - x;
        return {angle_of(way), 1 / length(way) * way};
      }
    }
    return direction_[v];
  }

 private:
  Domain domain_;
  double k_, mu_t_;
  std::vector<View> views_;
  std::vector<Direction> direction_;
  std::vector<double> phase_, log_magnitude_;
};

}  // namespace flatspeckle::mc

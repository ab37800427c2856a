#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "core/random.h"
#include "flatland/scene.h"
#include "grin/free_flight.h"
#include "mc/lights.h"
#include "mc/scattering.h"
#include "mc/views.h"

namespace flatspeckle::mc {

/// Walks light paths through a scene and gives each path of B = 1, 2, ... scatterers to an
/// accumulator: a weight and the field f of every channel, so that the mean of weight f_a conj(f_b)
/// over paths is the covariance (conventions, C14; Bar et al. 2019).
///
/// With reversed paths f = F + R, and the path is weighed by the mean of the densities with which
/// the walk would find it from either end. That is unbiased, because F + R does not change when a
/// path is turned round, and no |R|^2 can outgrow its weight.
template <typename Scattering, bool reversed, bool absorbing, bool near>
class PathKernel {
 public:
  PathKernel(const Scene& scene, const Scattering& scattering)
      : scene_(scene),
        scattering_(scattering),
        lights_(scene),
        views_(scene),
        light_first_(lights_.size()),
        light_last_(lights_.size()),
        density_(lights_.size()),
        forward_light_(lights_.size()),
        view_first_(views_.size()),
        view_last_(views_.size()),
        field_(scene.request.channels.size()) {}

  template <typename Accumulator>
  void walk(RandomStream& random, Accumulator& accumulator) {
    const auto lights = static_cast<double>(lights_.size());
    const auto light = static_cast<std::size_t>(random.uniform() * lights);
    const Vec2 first = lights_.sample_first(light, random);
    lights_.at(first, light_first_, density_);
    single_scattering(first, accumulator);

    const Direction start = scattering_.sample(lights_.direction(light), random.uniform());
    const double forward_density = start_density(start);
    for (std::size_t i = 0; i < lights_.size(); ++i)
      forward_light_[i] =
          product(light_first_[i], scattering_.amplitude(lights_.direction(i), start));
    if constexpr (reversed) views_.at(first, start.reversed(), scattering_, view_first_);

    const auto& medium = scene_.medium;
    double weight = medium.mu_s * medium.mu_s / medium.mu_t;
    const double low_weight = 0.2 * weight;
    Vec2 x = first;
    Direction w = start;
    while (true) {
      const double flight = grin::sample_free_flight(medium.mu_t, random.uniform());
      if (flight >= scene_.domain.distance_to_edge(x, w.w)) return;
      x = x + flight * w.w;
      multiple_scattering(x, w, weight, forward_density, accumulator);
      if constexpr (absorbing) {
        weight *= medium.albedo;
        if (weight < low_weight) {  // roulette
          if (random.uniform() < 0.5) return;
          weight *= 2;
        }
      }
      w = scattering_.sample(w, random.uniform());
    }
  }

 private:
  /// B = 1.
  template <typename Accumulator>
  void single_scattering(Vec2 x, Accumulator& accumulator) {
    double density = 0;
    for (double p : density_) density += p;
    density /= static_cast<double>(lights_.size());
    views_.attenuate(x, view_last_);
    const auto& channels = scene_.request.channels;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const auto [i, v] = channels[c];
      field_[c] = product(product(light_first_[i], view_last_[v]),
                          scattering_.amplitude(lights_.direction(i), views_.towards(v, x)));
    }
    accumulator.add(scene_.medium.mu_s / density, field_);
  }

  /// B >= 2, the last scatterer at x, reached along w.
  template <typename Accumulator>
  void multiple_scattering(Vec2 x, const Direction& w, double weight, double forward_density,
                           Accumulator& accumulator) {
    views_.at(x, w, scattering_, view_last_);
    const auto& channels = scene_.request.channels;
    if constexpr (reversed) {
      lights_.at(x, light_last_, density_);
      const Direction back = w.reversed();
      const double backward_density = start_density(back);
      for (std::size_t i = 0; i < lights_.size(); ++i)
        light_last_[i] = product(light_last_[i], scattering_.amplitude(lights_.direction(i), back));
      for (std::size_t c = 0; c < channels.size(); ++c) {
        const auto [i, v] = channels[c];
        field_[c] =
            product(forward_light_[i], view_last_[v]) + product(light_last_[i], view_first_[v]);
      }
      accumulator.add(weight / (forward_density + backward_density), field_);
    } else {
      for (std::size_t c = 0; c < channels.size(); ++c)
        field_[c] = product(forward_light_[channels[c].light], view_last_[channels[c].view]);
      accumulator.add(weight / forward_density, field_);
    }
  }

  /// Density of a first scatterer where `density_` was taken, left along `start`.
  double start_density(const Direction& start) const {
    double sum = 0;
    for (std::size_t i = 0; i < lights_.size(); ++i)
      sum += density_[i] * scattering_.density(lights_.direction(i), start);
    return sum / static_cast<double>(lights_.size());
  }

  const Scene& scene_;
  const Scattering& scattering_;
  Lights lights_;
  Views<near> views_;
  std::vector<Complex> light_first_,
      light_last_;                      ///< e_i (light_last_ then times A) at the path's ends
  std::vector<double> density_;         ///< of each light's sampling, where last asked
  std::vector<Complex> forward_light_;  ///< e_i(first) A(i -> start)
  std::vector<Complex> view_first_, view_last_;  ///< A e_v at the path's ends
  std::vector<Complex> field_;                   ///< per channel
};

}  // namespace flatspeckle::mc

#pragma once

#include <cmath>
#include <vector>

#include "core/numbers/random.h"
#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/near_rays.h"
#include "mc/paths/endpoint_factors/profile_flight.h"
#include "mc/paths/endpoint_factors/varying_scattering.h"
#include "mc/paths/walk/bounded_stretched_flight.h"

namespace flatspeckle::mc {

/// Which of the request's lights paths are started for: so many that every light has one whose
/// attenuation and phase function are close to its own. The rest need no density of their own.
Lights representative_lights(const Scene& scene);

/// Samples a path's first scatterer and first direction by the attenuation, shape and phase
/// function of the representative lights, all having equal shares, and knows the density of the
/// mixture. Plane waves reach deeper than their attenuation where depth is worth it.
class FirstScatterer {
 public:
  /// rise: of the logarithm of what a place is worth, per depth; 0 samples plain attenuation.
  explicit FirstScatterer(const Scene& scene, double rise = 0);

  struct Sample {
    Vec2 x, arrival;
  };
  /// Plane waves: uniform across the aperture, attenuated along the ray, never outside.
  Sample sample(RandomStream& random) const {
    const auto number = static_cast<std::size_t>(random.uniform() * count_);
    if (number >= plane_.size()) [[unlikely]]
      return sample_near(number - plane_.size(), random);
    const Vec2 w = plane_[number];
    const Vec2 entry = sample_entry(w, random);
    const double chord = domain_.distance_to_edge(entry, w);
    if (profile_ != nullptr) [[unlikely]]
      return {entry + ProfileFlight(*profile_, entry, w, chord).sample(random.uniform()) * w, w};
    return {entry + flight(w, chord).sample(random.uniform()) * w, w};
  }

  /// Of the first scatterer alone, per area (per depth of a slab).
  double density(Vec2 x) const {
    double sum = 0;
    for (Vec2 w : plane_) sum += density(x, w);
    if (has_near()) [[unlikely]]
      sum += near_sum(x, [](Vec2) { return 1.0; });
    return sum / count_;
  }

  /// Of the first scatterer and the direction in which it is left.
  template <typename Scattering>
  double density(Vec2 x, const typename Scattering::Direction& start,
                 const Scattering& scattering) const {
    double sum = 0;
    const auto& here = local(scattering, x);
    for (Vec2 w : plane_) sum += density(x, w) * here.density(w, start);
    if (has_near()) [[unlikely]]
      sum += near_sum(x, [&](Vec2 arrival) { return here.density(arrival, start); });
    return sum / count_;
  }

 private:
  double density(Vec2 x, Vec2 w) const {
    const double behind = domain_.distance_to_edge(x, -w);
    const double chord = behind + domain_.distance_to_edge(x, w);
    if (profile_ != nullptr) [[unlikely]]
      return ProfileFlight(*profile_, x - behind * w, w, chord).density(behind) / aperture(w);
    return flight(w, chord).density(behind) / aperture(w);
  }

  BoundedStretchedFlight flight(Vec2 w, double chord) const { return {mu_t_, chord, pull_ * w.z}; }

  bool has_near() const { return plane_.size() < static_cast<std::size_t>(count_); }

  /// Out of line: plane waves must not pay for it.
  template <typename Factor>
  [[gnu::noinline]] double near_sum(Vec2 x, Factor factor) const {
    double sum = 0;
    for (const auto& rays : point_) sum += rays.density(x) * factor(rays.arrival(x));
    for (const auto& rays : beam_) sum += rays.density(x) * factor(rays.arrival(x));
    return sum;
  }

  [[gnu::noinline]] Sample sample_near(std::size_t number, RandomStream& random) const {
    const auto from = [&](const auto& rays) {
      const Vec2 x = rays.sample(random);
      return Sample{x, rays.arrival(x)};
    };
    return number < point_.size() ? from(point_[number]) : from(beam_[number - point_.size()]);
  }

  /// Length across which the light meets the medium; per unit length of a slab.
  double aperture(Vec2 w) const {
    if (domain_.kind == Domain::Kind::slab) return std::abs(w.z);
    return domain_.width * std::abs(w.z) + domain_.depth * std::abs(w.x);
  }

  Vec2 sample_entry(Vec2 w, RandomStream& random) const {
    const double far_z = w.z > 0 ? 0 : domain_.depth;
    if (domain_.kind == Domain::Kind::slab) return {0, far_z};
    const double across = random.uniform() * aperture(w);
    const double through_face = domain_.width * std::abs(w.z);
    if (across < through_face) return {across / std::abs(w.z) - domain_.width / 2, far_z};
    const double side = w.x > 0 ? -domain_.width / 2 : domain_.width / 2;
    return {side, (across - through_face) / std::abs(w.x)};
  }

  Domain domain_;
  const MediumProfile* profile_;  ///< null where the medium is the same everywhere
  double mu_t_, pull_;
  std::vector<Vec2> plane_;
  std::vector<PointRays> point_;
  std::vector<BeamRays> beam_;
  double count_ = 0;  ///< of all
};

}  // namespace flatspeckle::mc

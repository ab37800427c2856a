#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core/numbers/random.h"
#include "flatland/media/domain.h"
#include "flatland/request/light.h"
#include "flatland/scene/scene.h"
#include "grin/media/scattering/free_flight.h"
#include "mc/paths/endpoint_factors/end_factors.h"
#include "mc/paths/endpoint_factors/gaussian_beam.h"
#include "mc/paths/endpoint_factors/profile_flight.h"
#include "mc/paths/endpoint_factors/varying_scattering.h"
#include "mc/paths/walk/scene_scattering.h"

namespace flatspeckle::mc {

/// As grin::StretchedFlight, of flights that stay inside. Without stretched ones the variance has
/// no bound but the depth of the medium, from a pull of 1/2 on.
class BoundedStretchedFlight {
 public:
  BoundedStretchedFlight(double mu_t, double longest, double pull)
      : plain_{mu_t, longest}, pull_(pull) {}

  double sample(double u) const {
    if (pull_ <= 0) return plain_.sample(u);
    return u < 0.5 ? stretched().sample(2 * u) : plain_.sample(2 * u - 1);
  }
  double density(double distance) const {
    if (pull_ <= 0) return plain_.density(distance);
    return (plain_.density(distance) + stretched().density(distance)) / 2;
  }
  /// Of a flight so long: the density of all flights over that of those sampled.
  double weight(double distance) const {
    if (pull_ <= 0) return plain_.probability();
    return plain_.probability() * plain_.density(distance) / density(distance);
  }

 private:
  grin::BoundedFlight stretched() const {
    return {(1 - std::min(pull_, grin::StretchedFlight::most_pull)) * plain_.mu_t, plain_.longest};
  }

  grin::BoundedFlight plain_;
  double pull_;
};

/// The part of a ray from an origin that lies in the medium.
struct Chord {
  double enter, leave;
  double length() const { return leave - enter; }
};
/// Through a box, for enter >= least; no longer than 0 where the ray misses it.
Chord chord_through(const Domain& box, Vec2 origin, Vec2 w, double least);

/// First scatterers of a point source in a box or outside it: uniform in angle over what the box
/// subtends, attenuated along the ray.
class PointRays {
 public:
  PointRays(const Domain& box, const Extinction& extinction, Vec2 source);

  Vec2 sample(RandomStream& random) const;
  double density(Vec2 x) const;  ///< per area
  Vec2 arrival(Vec2 x) const;

 private:
  Domain box_;
  Extinction extinction_;
  Vec2 source_;
  double first_angle_, wedge_;
};

/// First scatterers of a beam in a box: Gaussian across, of the intensity's width at one distance
/// from the focus, attenuated along the axis.
class BeamRays {
 public:
  BeamRays(const Domain& box, const Extinction& extinction, const GaussianBeam& beam, double width);

  /// Whether the box lies beyond two widths.
  bool misses() const { return nearest_ > 4 * sigma_; }
  Vec2 sample(RandomStream& random) const;
  double density(Vec2 x) const;  ///< per area
  Vec2 arrival(Vec2 x) const { return beam_.ray(x); }

 private:
  double sample_across(RandomStream& random) const;

  Domain box_;
  Extinction extinction_;
  GaussianBeam beam_;
  double sigma_, low_, high_;  ///< of the coordinate across; between them it meets the box
  double nearest_;             ///< the least |coordinate across| of them
  double share_;               ///< of the Gaussian that lies between them
};

/// Of the narrowest and the widest that the beam is in the box: together they cover it. Throws
/// InputError for a beam that misses the box.
std::vector<BeamRays> beam_rays(const Domain& box, const Extinction& extinction,
                                const GaussianBeam& beam);

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

/// First scatterers of a path where light is bent (as first_scatterer.h): a ray of one of the
/// representative lights, uniform over those that meet the domain, attenuated along it in sigma.
class GradedFirst {
 public:
  GradedFirst(const Scene& scene, const GradedScattering& scattering);

  struct Sample {
    Vec2 x, arrival;
    bool hit = true;  ///< else the ray misses the domain, and the path has no scatterer
  };
  Sample sample(RandomStream& random) const;

  double density(Vec2 x) const;
  double density(Vec2 x, Vec2 start, const GradedScattering& scattering) const;

 private:
  struct Rays {
    std::shared_ptr<const Wavefront> wave;
    Light light;
    double low, high;   ///< of the launch of rays that meet the domain
    double per_launch;  ///< of a unit wave, power per launch: |cos| of a plane wave, else 1
  };
  Rays rays_of(const Light& light) const;
  RayPlace launched(const Rays& rays, double launch) const;
  double density(const Rays& rays, const Arrival& arrival, Vec2 x) const;

  Domain domain_;
  double mu_t_;
  const GradedMedium& medium_;
  std::vector<Rays> lights_;
  std::optional<FirstScatterer> straight_;  ///< where refraction is in the end factors alone
};

}  // namespace flatspeckle::mc

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
#include "mc/jobs/light_aperture.h"
#include "mc/paths/endpoint_factors/endpoint_factors.h"
#include "mc/paths/endpoint_factors/gaussian_beam.h"
#include "mc/paths/endpoint_factors/profile_flight.h"
#include "mc/paths/endpoint_factors/varying_scattering.h"
#include "mc/paths/walk/scene_scattering.h"

namespace flatspeckle::mc {

/// Lengths of free flights under the condition that the flight ends inside the medium. If the bias
/// is positive, half of the flights are biased by the exponential transform, as in
/// grin::BiasedFlight. If all flights were biased, by 1/2 or more, the variance would be bounded
/// only by the depth of the medium.
class BoundedBiasedFlight {
 public:
  BoundedBiasedFlight(double mu_t, double longest, double bias)
      : plain_{mu_t, longest}, bias_(bias) {}

  double sample(double u) const {
    if (bias_ <= 0) return plain_.sample(u);
    return u < 0.5 ? biased().sample(2 * u) : plain_.sample(2 * u - 1);
  }
  double density(double distance) const {
    if (bias_ <= 0) return plain_.density(distance);
    return (plain_.density(distance) + biased().density(distance)) / 2;
  }
  /// Returns the weight of a flight of this length: the density of unbounded, unbiased flights
  /// divided by the density from which the flight is sampled.
  double weight(double distance) const {
    if (bias_ <= 0) return plain_.probability();
    return plain_.probability() * plain_.density(distance) / density(distance);
  }

 private:
  grin::BoundedFlight biased() const {
    return {(1 - std::min(bias_, grin::BiasedFlight::largest_bias)) * plain_.mu_t, plain_.longest};
  }

  grin::BoundedFlight plain_;
  double bias_;
};

/// Part of a ray inside the medium, between two distances from the origin of the ray.
struct Chord {
  double enter, leave;
  double length() const { return leave - enter; }
};
/// Returns the part of a ray inside a box, without points nearer to the origin of the ray than
/// `least`. The length of the chord is 0 or negative if the ray misses the box.
Chord chord_through(const Domain& box, Vec origin, Vec w, double least);

/// Samples the first scatterer of a path from a point source inside or outside a box. The direction
/// of the ray is uniform over the angles under which the source sees the box or, in space, over a
/// cone that contains the box. The distance follows from the attenuation along the ray.
class PointRays {
 public:
  PointRays(const Domain& box, const Extinction& extinction, Vec source);

  /// Returns nullopt for a ray of the cone that misses the box.
  std::optional<Vec> sample(RandomStream& random) const;
  double density(Vec x) const;  ///< density of sample() at x, per area or volume
  Vec arrival(Vec x) const;

 private:
  Vec sample_direction(RandomStream& random) const;

  Domain box_;
  Extinction extinction_;
  Vec source_;
  double first_angle_ = 0;  ///< of the wedge in the plane
  Vec axis_;                ///< of the cone in space
  double measure_;          ///< angle of the wedge or solid angle of the cone
};

/// Samples the first scatterer of a path from a Gaussian beam in a box. Its density across the axis
/// of the beam is Gaussian, with the width of the beam's intensity at one distance from the focus,
/// within limits that contain the box. Its density along the axis follows from the attenuation.
/// width: 1/e radius of the beam's field at that distance (GaussianBeam::width()).
class BeamRays {
 public:
  BeamRays(const Domain& box, const Extinction& extinction, const GaussianBeam& beam, double width);

  /// Whether the whole box lies more than two beam widths away from the axis of the beam.
  bool misses() const;
  /// Returns nullopt for a ray that misses the box, which is possible only in space.
  std::optional<Vec> sample(RandomStream& random) const;
  double density(Vec x) const;  ///< density of sample() at x, per area or volume
  Vec arrival(Vec x) const { return beam_.ray(x); }

 private:
  /// Coordinate perpendicular to the axis of the beam.
  struct Across {
    double low, high;  ///< smallest and largest value in the box
    double nearest;    ///< smallest modulus in the box
    double share;      ///< probability that the Gaussian lies in [low, high]
  };
  double sample(const Across& across, RandomStream& random) const;
  Chord chord(Vec origin) const;

  Domain box_;
  Extinction extinction_;
  GaussianBeam beam_;
  double sigma_;  ///< standard deviation of the Gaussian
  std::vector<Across> across_;
};

/// Returns samplers that together cover a beam: one with the largest width that the beam has in the
/// box and, if it is much smaller, one with the smallest width. Throws InputError for a beam that
/// misses the box.
std::vector<BeamRays> beam_rays(const Domain& box, const Extinction& extinction,
                                const GaussianBeam& beam);

/// Selects the lights of the request from which paths start. Every light differs so little from a
/// selected light, in its attenuation and in the directions of scattering, that paths from the
/// selected lights sample all lights well.
Lights representative_lights(const Scene& scene);

/// Samples the first scatterer of a path: selects one of the representative_lights() with equal
/// probabilities, then a random ray of this light, then a scatterer on the ray by the attenuation
/// along it. Evaluates the density of this mixture, alone or jointly with the direction in which
/// the path leaves the first scatterer. For plane waves, deep scatterers are sampled more
/// frequently if the importance grows with depth.
class FirstScatterer {
 public:
  /// mean_derivative: DiffusionImportance::mean_derivative() of the log importance with respect to
  /// depth; 0 for unbiased flights.
  explicit FirstScatterer(const Scene& scene, double mean_derivative = 0);

  struct Sample {
    Vec x, arrival;
    bool hit = true;  ///< whether the ray meets the medium; if not, the path has no scatterer
  };
  /// Samples the first scatterer and the direction in which the light arrives there. For plane
  /// waves the point of entry is uniform over the cross-section of the medium, and the free flight
  /// always ends inside the medium.
  Sample sample(RandomStream& random) const {
    const auto number = static_cast<std::size_t>(random.uniform() * count_);
    if (number >= plane_.size()) [[unlikely]]
      return sample_near(number - plane_.size(), random);
    const Vec w = plane_[number].light();
    const Vec entry = plane_[number].sample(random);
    const double chord = domain_.distance_to_edge(entry, w);
    if (profile_ != nullptr) [[unlikely]]
      return {entry + ProfileFlight(*profile_, entry, w, chord).sample(random.uniform()) * w, w};
    return {entry + flight(w, chord).sample(random.uniform()) * w, w};
  }

  /// Returns the density of the position of the first scatterer: per area or, in a slab, per depth.
  double density(Vec x) const {
    double sum = 0;
    for (const LightAperture& wave : plane_) sum += density(x, wave);
    if (has_near()) [[unlikely]]
      sum += near_sum(x, [](Vec) { return 1.0; });
    return sum / count_;
  }

  /// Returns the joint density of the position of the first scatterer and of the direction in which
  /// the path leaves it.
  template <typename Scattering>
  double density(Vec x, Vec start, const Scattering& scattering) const {
    double sum = 0;
    const auto& here = local(scattering, x);
    for (const LightAperture& wave : plane_)
      sum += density(x, wave) * here.density(wave.light(), start);
    if (has_near()) [[unlikely]]
      sum += near_sum(x, [&](Vec arrival) { return here.density(arrival, start); });
    return sum / count_;
  }

 private:
  double density(Vec x, const LightAperture& wave) const {
    const Vec w = wave.light();
    const double behind = domain_.distance_to_edge(x, -w);
    const double chord = behind + domain_.distance_to_edge(x, w);
    if (profile_ != nullptr) [[unlikely]]
      return ProfileFlight(*profile_, x - behind * w, w, chord).density(behind) / wave.all();
    return flight(w, chord).density(behind) / wave.all();
  }

  BoundedBiasedFlight flight(Vec w, double chord) const { return {mu_t_, chord, bias_ * w.z}; }

  bool has_near() const { return plane_.size() < static_cast<std::size_t>(count_); }

  /// Sums density times factor(direction of arrival at x) over the samplers of point sources and
  /// beams. It is not inlined, so that it does not slow down plane waves.
  template <typename Factor>
  [[gnu::noinline]] double near_sum(Vec x, Factor factor) const {
    double sum = 0;
    for (const auto& rays : point_) sum += rays.density(x) * factor(rays.arrival(x));
    for (const auto& rays : beam_) sum += rays.density(x) * factor(rays.arrival(x));
    return sum;
  }

  [[gnu::noinline]] Sample sample_near(std::size_t number, RandomStream& random) const {
    const auto from = [&](const auto& rays) {
      const std::optional<Vec> x = rays.sample(random);
      return x ? Sample{*x, rays.arrival(*x)} : Sample{{}, {}, false};
    };
    return number < point_.size() ? from(point_[number]) : from(beam_[number - point_.size()]);
  }

  Domain domain_;
  const MediumProfile* profile_;  ///< null if the medium is homogeneous
  double mu_t_, bias_;
  std::vector<LightAperture> plane_;
  std::vector<PointRays> point_;
  std::vector<BeamRays> beam_;
  double count_ = 0;  ///< number of samplers of all three kinds
};

/// Samples the first scatterer of a path if rays are curved, as FirstScatterer does for straight
/// rays. Selects a representative light, then one of its rays that meet the domain (uniformly in
/// Arrival::launch), then a scatterer on this ray. Attenuation is exponential in the ray parameter
/// sigma (conventions, C31).
class GradedFirst {
 public:
  GradedFirst(const Scene& scene, const GradedScattering& scattering);

  using Sample = FirstScatterer::Sample;
  Sample sample(RandomStream& random) const;

  double density(Vec x) const;
  double density(Vec x, Vec start, const GradedScattering& scattering) const;

 private:
  struct Rays {
    std::shared_ptr<const Wavefront> wave;
    Light light;
    double low, high;  ///< range of Arrival::launch of the rays that meet the domain
    /// Power of a light of unit amplitude per unit of Arrival::launch: |cos(angle)| for a plane
    /// wave, 1 for a point source
    double per_launch;
  };
  Rays rays_of(const Light& light) const;
  RayPlace launched(const Rays& rays, double launch) const;
  double density(const Rays& rays, const Arrival& arrival, Vec x) const;

  Domain domain_;
  double mu_t_;
  const GradedMedium& medium_;
  std::vector<Rays> lights_;
  /// set if rays are straight: refraction changes only the endpoint factors
  std::optional<FirstScatterer> straight_;
};

}  // namespace flatspeckle::mc

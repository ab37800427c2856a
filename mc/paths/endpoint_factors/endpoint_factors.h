#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "grin/media/scattering/free_flight.h"
#include "mc/paths/endpoint_factors/gaussian_beam.h"
#include "mc/paths/endpoint_factors/profile_flight.h"
#include "mc/paths/endpoint_factors/scattering.h"

namespace flatspeckle::mc {

/// Extinction along rays in the medium of a scene: mu_t, or the profile if the medium varies.
struct Extinction {
  double mu_t;
  const MediumProfile* profile = nullptr;  ///< set if the medium varies, else null

  explicit Extinction(const Scene& scene) : mu_t(scene.medium.mu_t), profile(scene.profile.get()) {}

  double optical_depth(Vec2 x, Vec2 w, double length) const {
    return profile != nullptr ? profile->optical_depth(x, w, length) : mu_t * length;
  }
  /// Samples the length of a free flight under the condition that it is no longer than `longest`.
  /// flight_density() is the density of this length.
  double sample_flight(Vec2 x, Vec2 w, double longest, double u) const {
    if (profile != nullptr) return ProfileFlight(*profile, x, w, longest).sample(u);
    return grin::BoundedFlight{mu_t, longest}.sample(u);
  }
  double flight_density(Vec2 x, Vec2 w, double longest, double distance) const {
    if (profile != nullptr) return ProfileFlight(*profile, x, w, longest).density(distance);
    return grin::BoundedFlight{mu_t, longest}.density(distance);
  }
};

/// Returns the outgoing wave whose far-field form is exp(i k r)/sqrt(r) (C4), at distance r. If k r
/// is small, the Hankel function itself is used instead of the far-field form (C13).
Complex outgoing_wave(double k, double r);

/// Endpoint of a path: an emitter or a sensor. By reciprocity both have the same form. A far light
/// along w is equivalent to a far view towards -w, because the amplitude A(w -> w_1) equals A(-w_1
/// -> -w). A point source is equivalent to a near sensor up to a factor (C13, [bar2020]).
struct Endpoint {
  /// true for a point or a beam, to which the direction depends on the place
  bool near = false;
  Vec2 towards;                        ///< far endpoint: unit vector from the medium to it
  Vec2 point;                          ///< position of a near endpoint
  Complex strength = 1;                ///< near point: factor of its field before outgoing_wave()
  std::optional<GaussianBeam> beam{};  ///< set for a light that is a beam
};
std::vector<Endpoint> light_endpoints(const Scene& scene);
std::vector<Endpoint> view_endpoints(const Scene& scene);

/// Endpoint factors e of C13 for a list of endpoints.
class EndpointFactors {
 public:
  virtual ~EndpointFactors() = default;

  std::size_t size() const { return directions_.size(); }

  /// Selects the wave of each endpoint that is computed: the number of its reflections at faces.
  virtual void choose(int /*wave*/) {}
  /// Computes out[j] = e_j(x).
  virtual void attenuate(Vec2 x, std::span<Complex> out) = 0;

  /// Returns the direction to endpoint j from the place x of the last call of attenuate().
  /// log_attenuation(j) is the logarithm of the attenuation of the field in this direction, -mu_t
  /// d/2, where d is the length inside the medium.
  Vec2 direction(std::size_t j) const { return directions_[j]; }
  const Directions& directions() const { return directions_; }
  double log_attenuation(std::size_t j) const { return log_attenuation_[j]; }

 protected:
  explicit EndpointFactors(std::size_t endpoints)
      : directions_(endpoints), log_attenuation_(endpoints) {}

  Directions directions_;
  std::vector<double> log_attenuation_;
};

/// Endpoint factors for straight rays. If `phases` is false, they are only magnitudes, which
/// suffice for intensities.
class StraightEndpoints : public EndpointFactors {
 public:
  StraightEndpoints(const Scene& scene, const std::vector<Endpoint>& endpoints, bool phases);

  void attenuate(Vec2 x, std::span<Complex> out) override;

 private:
  double distance_to_edge(std::size_t j, Vec2 x) const {
    return std::max(0.0, std::min((edge_x_[j] - x.x) * per_cosine_x_[j],
                                  (edge_z_[j] - x.z) * per_cosine_z_[j]));
  }
  /// Returns the log attenuation of the field over a length `inside` from x along w, bounded below
  /// by a value whose exp is 0.
  double log_magnitude(Vec2 x, Vec2 w, double inside) const;
  void attenuate_points(Vec2 x, std::span<Complex> out);
  void attenuate_beams(Vec2 x, std::span<Complex> out);

  Domain domain_;
  double k_;
  bool phases_;
  Extinction extinction_;
  struct PointEndpoint {
    std::size_t number;
    Vec2 point;
    Complex strength;
  };
  struct BeamEndpoint {
    std::size_t number;
    GaussianBeam beam;
  };
  std::vector<PointEndpoint> points_;
  std::vector<BeamEndpoint> beams_;
  // The distance from (x, z) to the edge of the medium is the smaller one of (edge_x - x)
  // per_cosine_x and (edge_z - z) per_cosine_z.
  std::vector<double> edge_x_, edge_z_, per_cosine_x_, per_cosine_z_;
  std::vector<double> phase_, magnitude_;
  std::vector<double> point_r_, point_phase_, point_log_;
  std::vector<Complex> point_wave_;
};

}  // namespace flatspeckle::mc

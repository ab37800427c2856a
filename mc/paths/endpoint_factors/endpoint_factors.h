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

  double optical_depth(Vec x, Vec w, double length) const {
    return profile != nullptr ? profile->optical_depth(x, w, length) : mu_t * length;
  }
  /// Samples the length of a free flight under the condition that it is no longer than `longest`.
  /// flight_density() is the density of this length.
  double sample_flight(Vec x, Vec w, double longest, double u) const {
    if (profile != nullptr) return ProfileFlight(*profile, x, w, longest).sample(u);
    return grin::BoundedFlight{mu_t, longest}.sample(u);
  }
  double flight_density(Vec x, Vec w, double longest, double distance) const {
    if (profile != nullptr) return ProfileFlight(*profile, x, w, longest).density(distance);
    return grin::BoundedFlight{mu_t, longest}.density(distance);
  }
};

/// Returns the outgoing wave in the plane whose far-field form is exp(i k r)/sqrt(r) (C4), at
/// distance r. If k r is small, the Hankel function itself is used instead of the far-field form
/// (C13).
Complex outgoing_wave(double k, double r);

/// Endpoint of a path: an emitter or a sensor. By reciprocity both have the same form. A far light
/// along w is equivalent to a far view towards -w, because the amplitude A(w -> w_1) equals A(-w_1
/// -> -w). A point source is equivalent to a near sensor up to a factor (C13, [bar2020]).
struct Endpoint {
  /// true for a point or a beam, to which the direction depends on the place
  bool near = false;
  Vec towards;                         ///< far endpoint: unit vector from the medium to it
  Vec point;                           ///< position of a near endpoint
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
  virtual void attenuate(Vec x, std::span<Complex> out) = 0;

  /// Returns the direction to endpoint j from the place x of the last call of attenuate().
  /// log_attenuation(j) is the logarithm of the attenuation of the field in this direction, -mu_t
  /// d/2, where d is the length inside the medium.
  Vec direction(std::size_t j) const { return directions_[j]; }
  const Directions& directions() const { return directions_; }
  double log_attenuation(std::size_t j) const { return log_attenuation_[j]; }

 protected:
  explicit EndpointFactors(std::size_t endpoints)
      : directions_(endpoints), log_attenuation_(endpoints) {}

  Directions directions_;
  std::vector<double> log_attenuation_;
};

/// Endpoint factors for straight rays, in the plane (C13) or in space (C58). If `phases`
/// is false, they are only magnitudes, which suffice for intensities.
class StraightEndpoints : public EndpointFactors {
 public:
  StraightEndpoints(const Scene& scene, const std::vector<Endpoint>& endpoints, bool phases);

  void attenuate(Vec x, std::span<Complex> out) override;

 private:
  template <bool in_space>
  double distance_to_edge(std::size_t j, Vec x) const {
    double distance = std::min(edge_x_.distance(j, x.x), edge_z_.distance(j, x.z));
    if constexpr (in_space) distance = std::min(distance, edge_y_.distance(j, x.y));
    return std::max(0.0, distance);
  }
  template <bool in_space>
  void attenuate_far(Vec x);
  /// Returns the log attenuation of the field over a length `inside` from x along w, bounded below
  /// by a value whose exp is 0.
  double log_magnitude(Vec x, Vec w, double inside) const;
  void attenuate_points(Vec x, std::span<Complex> out);
  void attenuate_beams(Vec x, std::span<Complex> out);

  Domain domain_;
  double k_;
  bool phases_, in_space_;
  Extinction extinction_;
  struct PointEndpoint {
    std::size_t number;
    Vec point;
    Complex strength;
  };
  struct BeamEndpoint {
    std::size_t number;
    GaussianBeam beam;
  };
  std::vector<PointEndpoint> points_;
  std::vector<BeamEndpoint> beams_;
  /// Edges of the medium perpendicular to an axis, which the rays to the endpoints would cross.
  struct Edges {
    std::vector<double> position, per_cosine;

    void add(double w, double low, double high);
    /// Returns the distance along ray j from the coordinate x on this axis to the edge.
    double distance(std::size_t j, double x) const { return (position[j] - x) * per_cosine[j]; }
  };
  Edges edge_x_, edge_z_, edge_y_;
  std::vector<double> phase_, magnitude_;
  std::vector<double> point_r_, point_phase_, point_log_;
  std::vector<Complex> point_wave_;
};

}  // namespace flatspeckle::mc

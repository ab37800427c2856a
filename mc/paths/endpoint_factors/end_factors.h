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

/// What a scene's medium takes from light on its way: mu_t, or where it varies its profile.
struct Extinction {
  double mu_t;
  const MediumProfile* profile = nullptr;  ///< null where mu_t is the same everywhere

  explicit Extinction(const Scene& scene) : mu_t(scene.medium.mu_t), profile(scene.profile.get()) {}

  double optical_depth(Vec2 x, Vec2 w, double length) const {
    return profile != nullptr ? profile->optical_depth(x, w, length) : mu_t * length;
  }
  /// A flight that is no longer than `longest`, and the density of such.
  double sample_flight(Vec2 x, Vec2 w, double longest, double u) const {
    if (profile != nullptr) return ProfileFlight(*profile, x, w, longest).sample(u);
    return grin::BoundedFlight{mu_t, longest}.sample(u);
  }
  double flight_density(Vec2 x, Vec2 w, double longest, double distance) const {
    if (profile != nullptr) return ProfileFlight(*profile, x, w, longest).density(distance);
    return grin::BoundedFlight{mu_t, longest}.density(distance);
  }
};

/// Field of a unit scatterer at distance r in the far-field form exp(ikr)/sqrt(r) (C4), by the
/// Hankel function itself where k r is small (C13).
Complex outgoing_wave(double k, double r);

/// Where light enters a path or leaves it. By reciprocity both are one thing: a far light along w
/// is a far view towards -w, its amplitude A(i -> w_1) that from -w_1 towards -w; a point source is
/// a near sensor but for a factor (C13).
struct End {
  bool near = false;  ///< a point, or a beam: the direction towards it depends on where one stands
  Vec2 towards;       ///< far: unit vector out of the medium
  Vec2 point;         ///< near
  Complex strength = 1;                ///< of a point: its field over outgoing_wave
  std::optional<GaussianBeam> beam{};  ///< a light
};
std::vector<End> light_ends(const Scene& scene);
std::vector<End> view_ends(const Scene& scene);

/// End factors e of C13 for a list of ends.
class EndFactors {
 public:
  virtual ~EndFactors() = default;

  std::size_t size() const { return directions_.size(); }

  /// out[j] = e_j(x)
  virtual void attenuate(Vec2 x, std::span<Complex> out) = 0;

  /// Towards the ends, from where attenuate() was called last, and the logarithm of what is left of
  /// the field on the way there: -mu_t d/2.
  Vec2 direction(std::size_t j) const { return directions_[j]; }
  const Directions& directions() const { return directions_; }
  double log_attenuation(std::size_t j) const { return log_attenuation_[j]; }

 protected:
  explicit EndFactors(std::size_t ends) : directions_(ends), log_attenuation_(ends) {}

  Directions directions_;
  std::vector<double> log_attenuation_;
};

/// Those of straight rays. Without phases they are magnitudes, which is all that intensities need.
class StraightEnds : public EndFactors {
 public:
  StraightEnds(const Scene& scene, const std::vector<End>& ends, bool phases);

  void attenuate(Vec2 x, std::span<Complex> out) override;

 private:
  double distance_to_edge(std::size_t j, Vec2 x) const {
    return std::max(0.0, std::min((edge_x_[j] - x.x) * per_cosine_x_[j],
                                  (edge_z_[j] - x.z) * per_cosine_z_[j]));
  }
  /// Of the field on the way to an edge or a near end, but for what exp makes 0 of anyway.
  double log_magnitude(Vec2 x, Vec2 w, double inside) const;
  void attenuate_points(Vec2 x, std::span<Complex> out);
  void attenuate_beams(Vec2 x, std::span<Complex> out);

  Domain domain_;
  double k_;
  bool phases_;
  Extinction extinction_;
  struct PointEnd {
    std::size_t number;
    Vec2 point;
    Complex strength;
  };
  struct BeamEnd {
    std::size_t number;
    GaussianBeam beam;
  };
  std::vector<PointEnd> points_;
  std::vector<BeamEnd> beams_;
  // Distance to the edge = min((edge - x) per_cosine) over both axes.
  std::vector<double> edge_x_, edge_z_, per_cosine_x_, per_cosine_z_;
  std::vector<double> phase_, magnitude_;
  std::vector<double> point_r_, point_phase_, point_log_;
  std::vector<Complex> point_wave_;
};

}  // namespace flatspeckle::mc

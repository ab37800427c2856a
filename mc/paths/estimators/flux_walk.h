#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "core/run/interrupt.h"
#include "flatland/scene/scene.h"
#include "grin/media/scattering/free_flight.h"
#include "mc/jobs/flux_job.h"

namespace flatspeckle::mc {

/// Adds up the power of the walks of one light: for each FluxShare and for each bin of the exit
/// angle.
class FluxTally {
 public:
  FluxTally(const Scene& scene, std::span<Complex> sums)
      : domain_(scene.domain), in_space_(scene.medium.dimension == 3), sums_(sums) {}

  void absorb(double power) const { sums_[absorbed] += power; }
  /// Adds the power of light that leaves the medium along w at the place x of its edge.
  void leave(Vec x, Vec w, double power) const {
    constexpr double rounding = 1e-12;
    const auto touches = [](double place, double size) {
      return size / 2 - std::abs(place) < rounding * size;
    };
    const bool side =
        domain_.kind == Domain::Kind::box &&
        (touches(x.x, domain_.width) || (domain_.height > 0 && touches(x.y, domain_.height)));
    const FluxShare through = side ? through_sides : w.z > 0 ? transmitted : reflected;
    const double turn = in_space_ ? std::acos(std::clamp(w.z, -1.0, 1.0)) / std::numbers::pi
                                  : angle_of(w) / (2 * std::numbers::pi) + 0.5;
    const std::size_t bins = sums_.size() - flux_shares;
    const auto bin = std::min(static_cast<std::size_t>(turn * static_cast<double>(bins)), bins - 1);
    sums_[through] += power;
    sums_[flux_shares + bin] += power;
  }

 private:
  Domain domain_;
  bool in_space_;
  std::span<Complex> sums_;
};

/// Where a light enters the medium, and the importance as a function of depth. Beyond a depth that
/// only a small fraction of the light reaches, the importance grows as exp(kappa depth), where
/// kappa is the decay rate of diffuse light. The number of walkers falls up to that depth and stays
/// constant beyond it, so all depths cost about the same. Depth is the distance from the face or
/// side through which most light enters.
class LightEntry {
 public:
  LightEntry(const Domain& domain, Vec light, double kappa)
      : light_(light), aperture_(domain, light_) {
    const double sides = std::max(aperture_.side(), aperture_.other_side());
    const bool through_face = aperture_.face() >= sides, through_x = sides == aperture_.side();
    const double thickness = through_face ? domain.depth : through_x ? domain.width : domain.height;
    inward_ = through_face ? Vec{0, std::copysign(1.0, light_.z)}
              : through_x  ? Vec{std::copysign(1.0, light_.x), 0}
                           : Vec{0, 0, std::copysign(1.0, light_.y)};
    start_ = inward_.z > 0 ? 0 : -(through_face ? domain.depth : thickness / 2);
    constexpr double least_decay_lengths = 2;  // measured value, as is the onset below
    if (kappa * thickness > least_decay_lengths) kappa_ = kappa;
    onset_ = std::log(std::max(4.0, kappa_ * thickness / 4));
  }

  Vec light() const { return light_; }
  bool has_importance() const { return kappa_ > 0; }

  /// Samples the point where light enters the medium, uniformly over its cross-section. In a slab
  /// one point represents all.
  Vec sample(RandomStream& random) const { return aperture_.sample(random); }

  double depth(Vec x) const { return dot(inward_, x) - start_; }
  double cosine(Vec w) const { return dot(inward_, w); }

  double importance(Vec x) const {
    if (!has_importance()) return 1;
    constexpr double largest = 600;  // logarithm whose exp is finite
    return std::exp(std::clamp(kappa_ * depth(x) - onset_, 0.0, largest));
  }

  /// Returns the factor by which the exponential transform (Dwivedi [dwivedi1982]) multiplies mu_t.
  /// With this factor, the product of weight and importance after a flight depends only on the
  /// direction of the flight.
  double mu_t_factor(Vec w, double mu_t) const {
    return std::max(0.0, 1 - kappa_ / mu_t * cosine(w));
  }

 private:
  Vec light_, inward_;
  LightAperture aperture_;
  double kappa_ = 0, onset_, start_;
};

/// Samples walks of light through a medium from the first collision on, and tallies where they end.
/// The ballistic part has a closed form. Escapes are tallied when they happen: measurements showed
/// that scoring the escape probability at every collision, or forcing collisions, costs more than
/// it gains.
template <typename Scattering>
class FluxWalk {
 public:
  FluxWalk(const Scene& scene, const Scattering& scattering, const LightEntry& entry,
           RandomStream& random, std::span<Complex> sums)
      : domain_(scene.domain),
        mu_t_(scene.medium.mu_t),
        albedo_(std::min(1.0, scene.medium.albedo)),
        g_(scene.medium.g),
        reach_(1 / (mu_t_ * (1 - g_))),
        scattering_(scattering),
        entry_(entry),
        faces_(scene.faces),
        random_(random),
        tally_(scene, sums),
        sums_(sums) {}

  /// Samples one walk. u: number in (0, 1), uniformly distributed, that selects the depth of the
  /// first collision.
  void walk(double u) {
    Vec start = entry_.sample(random_), w = entry_.light();
    const double chord = domain_.distance_to_edge(start, w);
    const double crossings = faces_ ? sample_crossings(w, chord) : 1;
    const grin::BoundedFlight plain{mu_t_, chord};
    const grin::BoundedFlight biased{mu_t_ * entry_.mu_t_factor(w, mu_t_), chord};
    const double flight = u < biased_fraction
                              ? biased.sample(u / biased_fraction)
                              : plain.sample((u - biased_fraction) / plain_fraction);
    const double density = plain.density(flight);
    const double mixture = plain_fraction * density + biased_fraction * biased.density(flight);
    power_ = -std::expm1(-mu_t_ * chord) * crossings;
    if (odd_crossings_) start = start + chord * w;
    if (odd_crossings_) w.z = -w.z;
    const Particle first{start + flight * w, w, density / mixture};
    martingale_ = -first.weight * expected_depth(first);
    collide(first);
    while (!flying_.empty()) {
      Particle particle = flying_.back();
      flying_.pop_back();
      if (fly(particle)) collide(particle);
    }
    if (domain_.kind == Domain::Kind::slab && !entry_.has_importance()) apply_control_variate();
  }

 private:
  struct Particle {
    Vec x, w;
    double weight;
  };

  /// Half of the flights are unbiased (plain) and half are biased. A flight therefore at most
  /// doubles the weight, and deep flights are frequent.
  static constexpr double plain_fraction = 0.5, biased_fraction = 1 - plain_fraction;

  /// Samples how often light of the beam crosses the medium between faces before it collides, and
  /// sets odd_crossings_ to whether the number of reflections is odd. Returns the power of all
  /// crossings, at the beginning of each, as a fraction of the incident power.
  double sample_crossings(Vec w, double chord) {
    const double reflectance = reflectance_at(w), next = reflectance * std::exp(-mu_t_ * chord);
    odd_crossings_ = false;
    if (next > 0)
      odd_crossings_ = std::fmod(std::floor(std::log(random_.uniform()) / std::log(next)), 2) == 1;
    return (1 - reflectance) / (1 - next);
  }

  /// Returns the reflectance of a face for light that arrives from the inside.
  double reflectance_at(Vec w) const { return faces_->leaving().reflectance(std::abs(w.z)); }

  /// Returns the direction in which light leaves.
  Vec outside(Vec w) const {
    if (!faces_) return w;
    return faces_->leaving().refracted(w);
  }

  /// Absorbs a fraction of the weight. Russian roulette and splitting keep the weight near 1 /
  /// importance.
  void collide(Particle particle) {
    tally_.absorb(power_ * particle.weight * (1 - albedo_));
    martingale_ += particle.weight * expected_depth(particle);
    particle.weight *= albedo_;
    const double expected = particle.weight * entry_.importance(particle.x);
    int copies = 1;
    if (expected < 0.5) {
      if (random_.uniform() > expected) return;
      particle.weight /= expected;
    } else if (expected > 2) {
      constexpr double most_copies = 64;
      copies = static_cast<int>(std::min(expected, most_copies));
      particle.weight /= copies;
    }
    martingale_ -= copies * particle.weight * expected_depth(particle);
    for (int i = 0; i < copies; ++i)
      flying_.push_back({particle.x, scattering_.sample(particle.w, random_), particle.weight});
  }

  /// Moves a particle to its next collision; returns false if the particle leaves the medium
  /// before. Faces reflect particles at random.
  bool fly(Particle& particle) {
    while (!fly_to_edge(particle)) {
      if (!faces_ || random_.uniform() >= reflectance_at(particle.w)) {
        leave(particle);
        return false;
      }
      const Vec before = particle.w;
      particle.w.z = -before.z;
      martingale_ += particle.weight * reach_ * (entry_.cosine(before) - entry_.cosine(particle.w));
    }
    return true;
  }

  /// Moves a particle to its next collision, or to the edge of the medium; returns whether it
  /// collides.
  bool fly_to_edge(Particle& particle) {
    constexpr std::uint64_t between_checks = 4096;
    if (++flights_ % between_checks == 0) stop_if_interrupted();
    const double factor = entry_.mu_t_factor(particle.w, mu_t_);
    const double edge = domain_.distance_to_edge(particle.x, particle.w);
    const double u = random_.uniform();
    const double flight = u < biased_fraction
                              ? -std::log(u / biased_fraction) / (mu_t_ * factor)
                              : -std::log((u - biased_fraction) / plain_fraction) / mu_t_;
    const bool inside = flight < edge;
    const double distance = inside ? flight : edge;
    if (factor != 1)
      particle.weight /= plain_fraction + biased_fraction * (inside ? factor : 1) *
                                              std::exp(mu_t_ * (1 - factor) * distance);
    particle.x = particle.x + distance * particle.w;
    return inside;
  }

  void leave(const Particle& particle) {
    tally_.leave(particle.x, outside(particle.w), power_ * particle.weight);
    martingale_ +=
        particle.weight * (entry_.depth(particle.x) + reach_ * entry_.cosine(particle.w));
  }

  /// Returns the expected final depth of light that arrives at a collision, in a medium without
  /// edges and absorption. It is a martingale: whatever the previous path, its mean at the next
  /// collision equals its value at this collision. The sum over a walk of weight times the changes
  /// of this depth (martingale_) therefore has mean 0. For light that leaves the medium, the value
  /// at the next collision is replaced by its mean, the depth of the exit point + reach_ cos.
  double expected_depth(const Particle& arriving) const {
    return entry_.depth(arriving.x) + g_ * reach_ * entry_.cosine(arriving.w);
  }

  /// Applies the martingale as a control variate: martingale_ is close to the depth of the slab for
  /// light that left through the far face, and close to 0 for light that returned. In a lossless
  /// slab of optical depth 100 this reduces the variance as much as 3000 times as many walks would.
  void apply_control_variate() {
    constexpr double extrapolation = 0.818;  // in units of reach_ (C20), at each face
    const double share = power_ * martingale_ / (domain_.depth + 2 * extrapolation * reach_);
    sums_[transmitted] -= share;
    sums_[reflected] += share;
  }

  Domain domain_;
  double mu_t_, albedo_, g_;
  double reach_;  ///< transport mean free path without absorption
  const Scattering& scattering_;
  const LightEntry& entry_;
  std::optional<Faces> faces_;
  bool odd_crossings_ = false;  ///< of the beam before the first collision (sample_crossings())
  RandomStream& random_;
  FluxTally tally_;
  std::span<Complex> sums_;
  double power_ = 0;  ///< fraction of the light on the incident ray that collides
  double martingale_ = 0;
  std::vector<Particle> flying_;
  std::uint64_t flights_ = 0;
};

}  // namespace flatspeckle::mc

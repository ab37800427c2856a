#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "core/run/interrupt.h"
#include "flatland/scene/scene.h"
#include "grin/media/scattering/free_flight.h"
#include "mc/jobs/flux_job.h"

namespace flatspeckle::mc {

/// Where light ends, by share and exit angle: the sums of one light.
class FluxTally {
 public:
  FluxTally(const Domain& domain, std::span<Complex> sums) : domain_(domain), sums_(sums) {}

  void absorb(double power) const { sums_[absorbed] += power; }
  /// At the edge.
  void leave(Vec2 x, Vec2 w, double power) const {
    constexpr double rounding = 1e-12;
    const double to_side = domain_.width / 2 - std::abs(x.x);
    const bool side = domain_.kind == Domain::Kind::box && to_side < rounding * domain_.width;
    const FluxShare through = side ? through_sides : w.z > 0 ? transmitted : reflected;
    const double turn = angle_of(w) / (2 * std::numbers::pi) + 0.5;
    const std::size_t bins = sums_.size() - flux_shares;
    const auto bin = std::min(static_cast<std::size_t>(turn * static_cast<double>(bins)), bins - 1);
    sums_[through] += power;
    sums_[flux_shares + bin] += power;
  }

 private:
  Domain domain_;
  std::span<Complex> sums_;
};

/// Where a light comes in, and how light that got deep is favoured. The importance of a place grows
/// as exp(kappa depth), kappa the rate at which diffuse light dies out, from the depth on to which
/// only a small share of the light comes: the number of walkers first falls, then stays, and deep
/// walks cost about as much as shallow ones. Depth is counted from the face or side through which
/// most light enters.
class LightEntry {
 public:
  LightEntry(const Domain& domain, double light, double kappa)
      : is_slab_(domain.kind == Domain::Kind::slab),
        light_(direction(light)),
        aperture_(domain, light_) {
    const bool through_face = aperture_.face() >= aperture_.side();
    const double thickness = through_face ? domain.depth : domain.width;
    inward_ = through_face ? Vec2{0, std::copysign(1.0, light_.z)}
                           : Vec2{std::copysign(1.0, light_.x), 0};
    start_ = inward_.z > 0 ? 0 : -(through_face ? domain.depth : domain.width / 2);
    constexpr double worthwhile = 2;  // measured, as the onset
    if (kappa * thickness > worthwhile) kappa_ = kappa;
    onset_ = std::log(std::max(4.0, kappa_ * thickness / 4));
  }

  Vec2 light() const { return light_; }
  bool favours_deep() const { return kappa_ > 0; }

  /// A point of the outline, uniform across the light; of a slab one stands for all.
  Vec2 sample(RandomStream& random) const { return aperture_.at(is_slab_ ? 0 : random.uniform()); }

  double depth(Vec2 x) const { return dot(inward_, x) - start_; }
  double cosine(Vec2 w) const { return dot(inward_, w); }

  double importance(Vec2 x) const {
    if (!favours_deep()) return 1;
    constexpr double largest = 600;  // exp of it is finite
    return std::exp(std::clamp(kappa_ * depth(x) - onset_, 0.0, largest));
  }

  /// The factor of mu_t with which the weight after a flight, times the importance there, depends
  /// on the direction alone (Dwivedi 1982).
  double stretch(Vec2 w, double mu_t) const { return std::max(0.0, 1 - kappa_ / mu_t * cosine(w)); }

 private:
  bool is_slab_;
  Vec2 light_, inward_;
  LightAperture aperture_;
  double kappa_ = 0, onset_, start_;
};

/// Walks light through a medium from its first collision on and counts where it ends. The ballistic
/// part is left to a closed form. Escapes are counted where they happen: scoring the chance of
/// escape at every collision, or forcing collisions, cost more than it gained.
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
        random_(random),
        tally_(scene.domain, sums),
        sums_(sums) {}

  /// u: uniform in (0, 1), picks the depth of the first collision.
  void walk(double u) {
    const Vec2 start = entry_.sample(random_), w = entry_.light();
    const double chord = domain_.distance_to_edge(start, w);
    const grin::BoundedFlight plain{mu_t_, chord};
    const grin::BoundedFlight stretched{mu_t_ * entry_.stretch(w, mu_t_), chord};
    const double flight = u < stretched_share ? stretched.sample(u / stretched_share)
                                              : plain.sample((u - stretched_share) / plain_share);
    const double density = plain.density(flight);
    const double mixture = plain_share * density + stretched_share * stretched.density(flight);
    power_ = -std::expm1(-mu_t_ * chord);
    const Particle first{start + flight * w, w, density / mixture};
    drift_ = -first.weight * outlook(first);
    collide(first);
    while (!flying_.empty()) {
      Particle particle = flying_.back();
      flying_.pop_back();
      if (fly(particle)) collide(particle);
    }
    if (domain_.kind == Domain::Kind::slab && !entry_.favours_deep()) balance();
  }

 private:
  struct Particle {
    Vec2 x, w;
    double weight;
  };

  /// Flights are plain or stretched, half and half: weights at most double, and flights that reach
  /// deep are not left to chance.
  static constexpr double plain_share = 0.5, stretched_share = 1 - plain_share;

  /// Absorption by weight; roulette and splitting keep the weight near 1 / importance.
  void collide(Particle particle) {
    tally_.absorb(power_ * particle.weight * (1 - albedo_));
    drift_ += particle.weight * outlook(particle);
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
    drift_ -= copies * particle.weight * outlook(particle);
    for (int i = 0; i < copies; ++i)
      flying_.push_back({particle.x, scattering_.sample(particle.w, random_), particle.weight});
  }

  /// To the next collision; false if that would be outside.
  bool fly(Particle& particle) {
    constexpr std::uint64_t between_looks = 4096;
    if (++flights_ % between_looks == 0) stop_if_interrupted();
    const double stretch = entry_.stretch(particle.w, mu_t_);
    const double edge = domain_.distance_to_edge(particle.x, particle.w);
    const double u = random_.uniform();
    const double flight = u < stretched_share
                              ? -std::log(u / stretched_share) / (mu_t_ * stretch)
                              : -std::log((u - stretched_share) / plain_share) / mu_t_;
    const bool inside = flight < edge;
    const double distance = inside ? flight : edge;
    if (stretch != 1)
      particle.weight /= plain_share + stretched_share * (inside ? stretch : 1) *
                                           std::exp(mu_t_ * (1 - stretch) * distance);
    particle.x = particle.x + distance * particle.w;
    if (!inside) leave(particle);
    return inside;
  }

  void leave(const Particle& particle) {
    tally_.leave(particle.x, particle.w, power_ * particle.weight);
    drift_ += particle.weight * (entry_.depth(particle.x) + reach_ * entry_.cosine(particle.w));
  }

  /// How deep what arrives in a collision would get in the end, in a medium without edges and
  /// absorption. Its mean at the next collision is its value at this one, for any past: weight
  /// times its steps, summed over a walk (drift_), has mean 0. Beyond an edge the mean is all that
  /// is asked for, so light that leaves ends at edge + reach cos.
  double outlook(const Particle& arriving) const {
    return entry_.depth(arriving.x) + g_ * reach_ * entry_.cosine(arriving.w);
  }

  /// The drift as a control variate: light that left through the far face has drifted by about the
  /// depth, light that came back by about nothing. In a lossless slab of optical depth 100 this is
  /// worth 3000 times as many walks.
  void balance() {
    constexpr double extrapolation = 0.818;  // C20, of both faces
    const double share = power_ * drift_ / (domain_.depth + 2 * extrapolation * reach_);
    sums_[transmitted] -= share;
    sums_[reflected] += share;
  }

  Domain domain_;
  double mu_t_, albedo_, g_;
  double reach_;  ///< transport mean free path without absorption
  const Scattering& scattering_;
  const LightEntry& entry_;
  RandomStream& random_;
  FluxTally tally_;
  std::span<Complex> sums_;
  double power_ = 0;  ///< share of the light along this ray that collides
  double drift_ = 0;
  std::vector<Particle> flying_;
  std::uint64_t flights_ = 0;
};

}  // namespace flatspeckle::mc

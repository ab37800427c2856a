#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::oracles {

using grin::Vec3;

/// Analog light transport as in the textbooks, the oracle of the estimators: photons that fly,
/// scatter, are absorbed (they vanish) and leave, one by one and all of the same power. It shares
/// no code with them but the vector: other random numbers, other geometry, and in curved space
/// plain RK4 by arc length in small steps, without tangent maps or surfaces that anything knows of.

using Random = std::mt19937_64;

struct WalkMedium {
  enum class Law { isotropic, henyey_greenstein, rayleigh };
  double mu_s = 0, mu_a = 0;
  Law law = Law::isotropic;
  double g = 0;
  std::function<double(const Vec3&)> density = {};  ///< relative; nothing: 1
  double largest_density = 1;
};

/// A box or, where radius > 0, a sphere about `low`.
struct WalkShape {
  Vec3 low, high;
  double radius = 0;
};

struct WalkBall {
  Vec3 centre;
  double radius;
  WalkMedium medium = {};
  double index = 1;
};

/// An index that varies; rays take steps of `step` in arc length.
struct WalkIndex {
  std::function<double(const Vec3&)> n;
  std::function<Vec3(const Vec3&)> gradient;
  double step;
};

/// Balls are apart, or a later one is inside of one before it. `curved` is the index in the first
/// ball; without balls it fills everything.
struct WalkScene {
  WalkShape boundary;
  WalkMedium medium = {};
  std::vector<WalkBall> balls = {};
  double around = 1;  ///< index around the balls
  std::optional<WalkIndex> curved = {};
};

struct Photon {
  Vec3 x, direction;
  double optical_path = 0;
  int scatterings = 0;
  int ball = -1;  ///< the number of that which it is in; -1: around them
};

/// Where a photon starts; the caller says in which ball.
using PhotonSource = std::function<Photon(Random&)>;
/// Called for each photon that leaves, on the boundary.
using PhotonExit = std::function<void(const Photon&)>;

void walk_photons(const WalkScene& scene, const PhotonSource& source, std::uint64_t photons,
                  std::uint64_t seed, const PhotonExit& exit);

/// Sources.
PhotonSource point_source(const Vec3& x);
PhotonSource beam_source(const Vec3& centre, const Vec3& direction, double radius);
/// Lambertian from a disk.
PhotonSource lambertian_source(const Vec3& centre, const Vec3& normal, double radius);

/// What photons are worth to a detector, per photon sent out. A photon adds to a bin no more than
/// once, so that the squares of its shares tell the errors.
class PhotonTally {
 public:
  PhotonTally(std::size_t bins, std::uint64_t photons)
      : sum_(bins), squares_(bins), photons_(static_cast<double>(photons)) {}

  void add(std::size_t bin, double worth = 1) {
    sum_[bin] += worth;
    squares_[bin] += worth * worth;
  }
  std::size_t size() const { return sum_.size(); }
  double mean(std::size_t bin) const { return sum_[bin] / photons_; }
  double error(std::size_t bin) const;

 private:
  std::vector<double> sum_, squares_;
  double photons_;
};

}  // namespace flatspeckle::oracles

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::oracles {

using grin::Vec3;

/// Textbook photon tracing, a reference for the estimators. Photons of equal power are traced one
/// by one: they scatter until they are absorbed or leave the scene. Only the vector type is shared
/// with the estimators; random numbers and geometry are independent. In a graded index rays are
/// traced by plain RK4 in arc length with small steps, without tangent maps or crossing searches.

using Random = std::mt19937_64;

struct WalkMedium {
  enum class Law { isotropic, henyey_greenstein, rayleigh };
  double mu_s = 0, mu_a = 0;
  Law law = Law::isotropic;
  double g = 0;
  std::function<double(const Vec3&)> density = {};  ///< relative density; 1 everywhere if empty
  double largest_density = 1;
};

/// A box, or, if radius > 0, a sphere with centre `low`.
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

/// A graded index; rays take steps of `step` in arc length.
struct WalkIndex {
  std::function<double(const Vec3&)> n;
  std::function<Vec3(const Vec3&)> gradient;
  double step;
};

/// A scene of balls. Two balls must be disjoint, or the later one must be inside the earlier one.
/// `curved` is the graded index in the first ball, or in the whole scene if there are no balls.
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
  int ball = -1;  ///< index of the ball that contains it; -1: none
};

/// Samples the start of a photon and the ball that contains it.
using PhotonSource = std::function<Photon(Random&)>;
/// Called for each photon that leaves the scene, at its exit point on the boundary.
using PhotonExit = std::function<void(const Photon&)>;

void walk_photons(const WalkScene& scene, const PhotonSource& source, std::uint64_t photons,
                  std::uint64_t seed, const PhotonExit& exit);

// Sources.
PhotonSource point_source(const Vec3& x);
PhotonSource beam_source(const Vec3& centre, const Vec3& direction, double radius);
/// Returns a Lambertian source on a disk.
PhotonSource lambertian_source(const Vec3& centre, const Vec3& normal, double radius);

/// Mean scores of photons at a detector, per photon emitted. A photon scores in a bin at most once,
/// so the errors follow from the squares of the scores.
class PhotonTally {
 public:
  PhotonTally(std::size_t bins, std::uint64_t photons)
      : sum_(bins), squares_(bins), photons_(static_cast<double>(photons)) {}

  void add(std::size_t bin, double score = 1) {
    sum_[bin] += score;
    squares_[bin] += score * score;
  }
  std::size_t size() const { return sum_.size(); }
  double mean(std::size_t bin) const { return sum_[bin] / photons_; }
  double error(std::size_t bin) const;

 private:
  std::vector<double> sum_, squares_;
  double photons_;
};

}  // namespace flatspeckle::oracles

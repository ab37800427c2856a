#include "bench/oracles/slab_photons.h"

#include <cmath>

namespace flatspeckle::oracles {
namespace {

/// splitmix64 (Steele, Lea and Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u) {}
  double uniform() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (static_cast<double>((z ^ (z >> 31)) >> 11) + 0.5) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

class Photon {
 public:
  Photon(const SlabPhotons& slab, Random& random) : slab_(slab), random_(random) {}

  void run() {
    for (;;) {
      const double flight = -std::log(random_.uniform());
      x_ += flight * u_;
      y_ += flight * v_;
      z_ += flight * w_;
      if (z_ < 0 || z_ > slab_.optical_depth) return;
      weight_ *= slab_.albedo;
      if (weight_ < 1e-4 && !survives()) return;
      turn();
    }
  }

  bool is_through() const { return z_ > 0; }
  double weight() const { return weight_; }

 private:
  bool survives() {
    constexpr double chance = 0.1;
    weight_ = random_.uniform() < chance ? weight_ / chance : 0;
    return weight_ > 0;
  }

  double cosine() {
    const double g = slab_.g, r = random_.uniform();
    if (g == 0) return 2 * r - 1;
    const double t = (1 - g * g) / (1 - g + 2 * g * r);
    return (1 + g * g - t * t) / (2 * g);
  }

  void turn() {
    const double c = cosine();
    double a, b, square;  // the azimuth of a point in a disk
    do {
      a = 2 * random_.uniform() - 1;
      b = 2 * random_.uniform() - 1;
      square = a * a + b * b;
    } while (square > 1 || square == 0);
    const double s = std::sqrt(std::fmax(0, 1 - c * c) / square);
    a *= s;
    b *= s;
    const double across = std::sqrt(std::fmax(0, 1 - w_ * w_));
    if (across < 1e-5) {
      u_ = a;
      v_ = b;
      w_ = std::copysign(1, w_) * c;
      return;
    }
    const double u = u_, v = v_, w = w_;
    u_ = c * u + (a * u * w - b * v) / across;
    v_ = c * v + (a * v * w + b * u) / across;
    w_ = c * w - a * across;
  }

  const SlabPhotons& slab_;
  Random& random_;
  double x_ = 0, y_ = 0, z_ = 0, u_ = 0, v_ = 0, w_ = 1, weight_ = 1;
};

}  // namespace

CountedShares count_photons(const SlabPhotons& slab, std::uint64_t photons, std::uint64_t seed) {
  Random random(seed);
  double sums[2]{}, squares[2]{};
  for (std::uint64_t i = 0; i < photons; ++i) {
    Photon photon(slab, random);
    photon.run();
    const double weight = photon.weight();
    sums[photon.is_through()] += weight;
    squares[photon.is_through()] += weight * weight;
  }
  const double n = static_cast<double>(photons);
  const auto error = [&](int face) {
    const double mean = sums[face] / n;
    return std::sqrt((squares[face] / n - mean * mean) / n);
  };
  return {sums[0] / n, sums[1] / n, error(0), error(1)};
}

}  // namespace flatspeckle::oracles

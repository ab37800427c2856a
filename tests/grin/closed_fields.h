#pragma once

#include <cmath>
#include <vector>

#include "core/random.h"
#include "grin/ray.h"

namespace flatspeckle::grin::tests {

/// n^2 = 2 - r^2 out to r = sqrt 2, where n = 0: Luneburg's ball without its rim. Every ray is the
/// ellipse x0 cos sigma + v0 sin sigma (conventions, C27).
struct HarmonicBall {
  double excess(const Vec3& x) const {
    return (1 - x.squaredNorm()) / (1 + std::sqrt(2 - x.squaredNorm()));
  }
  IndexGradient gradient(const Vec3& x) const {
    const double e = excess(x);
    return {e, -x / (1 + e)};
  }
  IndexHessian hessian(const Vec3& x) const {
    const double n = 1 + excess(x);
    return {n - 1, -x / n, -Mat3::Identity() / n - x * x.transpose() / (n * n * n)};
  }
};

/// Maxwell's fisheye n = n0 / (1 + r^2/a^2).
struct Fisheye {
  double n0, a;

  double excess(const Vec3& x) const { return n0 / (1 + x.squaredNorm() / (a * a)) - 1; }
  IndexGradient gradient(const Vec3& x) const {
    const double n = 1 + excess(x);
    return {n - 1, -2 * n * n / (n0 * a * a) * x};
  }
  IndexHessian hessian(const Vec3& x) const {
    const double n = 1 + excess(x);
    const double c = -2 * n * n / (n0 * a * a);
    return {n - 1, c * x, c * Mat3::Identity() + 2 * c * c / n * x * x.transpose()};
  }
};

/// n^2 = n0^2 - alpha^2 (x^2 + y^2).
struct ParabolicGuide {
  double n0, alpha;

  double excess(const Vec3& x) const {
    return std::sqrt(n0 * n0 - alpha * alpha * x.head<2>().squaredNorm()) - 1;
  }
  IndexGradient gradient(const Vec3& x) const {
    const double n = 1 + excess(x);
    return {n - 1, -alpha * alpha / n * Vec3(x.x(), x.y(), 0)};
  }
  IndexHessian hessian(const Vec3& x) const {
    const auto [excess_here, slope] = gradient(x);
    const double n = 1 + excess_here;
    const Mat3 across = Vec3(1, 1, 0).asDiagonal();
    return {n - 1, slope, -(alpha * alpha * across + slope * slope.transpose()) / n};
  }
};

/// n = 1 + a sum of Gaussian blobs in the unit ball, of random heights up to +-height.
class BlobSum {
 public:
  BlobSum(RandomStream& random, int blobs, double height) {
    for (int i = 0; i < blobs; ++i) {
      Vec3 centre;
      for (double& coordinate : centre) coordinate = 2 * random.uniform() - 1;
      blobs_.push_back({centre, height * (2 * random.uniform() - 1), 0.3 + 0.4 * random.uniform()});
    }
  }
  double excess(const Vec3& x) const { return hessian(x).excess; }
  IndexGradient gradient(const Vec3& x) const {
    const IndexHessian all = hessian(x);
    return {all.excess, all.gradient};
  }
  IndexHessian hessian(const Vec3& x) const {
    IndexHessian sum{0, Vec3::Zero(), Mat3::Zero()};
    for (const Blob& blob : blobs_) {
      const double w = 1 / (blob.width * blob.width);
      const Vec3 r = x - blob.centre;
      const double value = blob.height * std::exp(-w * r.squaredNorm() / 2);
      sum.excess += value;
      sum.gradient -= w * value * r;
      sum.hessian += w * value * (w * r * r.transpose() - Mat3::Identity());
    }
    return sum;
  }

 private:
  struct Blob {
    Vec3 centre;
    double height, width;
  };
  std::vector<Blob> blobs_;
};

}  // namespace flatspeckle::grin::tests

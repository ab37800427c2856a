#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "grin/fields/index_field.h"

namespace flatspeckle::grin {

/// height exp(-|x - centre|^2 / (2 width^2))
struct GaussianBlob {
  Vec3 centre;
  double height, width;
};

/// n = 1 + background + sum of blobs.
class GaussianBlobs {
 public:
  explicit GaussianBlobs(std::vector<GaussianBlob> blobs, double background = 0)
      : blobs_(std::move(blobs)), background_(background) {}

  double excess(const Vec3& x) const {
    double sum = background_;
    for (const GaussianBlob& blob : blobs_) sum += value(blob, x - blob.centre);
    return sum;
  }
  IndexGradient gradient(const Vec3& x) const {
    IndexGradient sum{background_, Vec3::Zero()};
    for (const GaussianBlob& blob : blobs_) {
      const Vec3 r = x - blob.centre;
      const double e = value(blob, r);
      sum.excess += e;
      sum.gradient -= e / (blob.width * blob.width) * r;
    }
    return sum;
  }
  IndexHessian hessian(const Vec3& x) const {
    IndexHessian sum{background_, Vec3::Zero(), Mat3::Zero()};
    for (const GaussianBlob& blob : blobs_) {
      const Vec3 r = x - blob.centre;
      const double e = value(blob, r), area = blob.width * blob.width;
      sum.excess += e;
      sum.gradient -= e / area * r;
      sum.hessian += e / area * (r * r.transpose() / area - Mat3::Identity());
    }
    return sum;
  }

 private:
  static double value(const GaussianBlob& blob, const Vec3& r) {
    return blob.height * std::exp(-r.squaredNorm() / (2 * blob.width * blob.width));
  }

  std::vector<GaussianBlob> blobs_;
  double background_;
};

}  // namespace flatspeckle::grin

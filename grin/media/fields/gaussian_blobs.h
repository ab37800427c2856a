#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "core/numbers/wide/functions.h"
#include "grin/media/index/field_kind.h"
#include "grin/media/index/lanes.h"

namespace flatspeckle::grin {

/// A Gaussian blob, which adds height exp(-|x - centre|^2 / (2 width^2)) to the index.
struct GaussianBlob {
  Vec3 centre;
  double height, width;
};

/// Index field n = 1 + background + sum of all Gaussian blobs.
class GaussianBlobs {
 public:
  explicit GaussianBlobs(std::vector<GaussianBlob> blobs, double background = 0)
      : blobs_(std::move(blobs)), background_(background) {}

  const std::vector<GaussianBlob>& blobs() const { return blobs_; }

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
  void gradients(const LaneVectors& x, LaneGradients& found) const {
    LaneGradients sum{};
    for (const GaussianBlob& blob : blobs_) {
      const double height = blob.height, steep = 1 / (blob.width * blob.width);
      const double cx = blob.centre[0], cy = blob.centre[1], cz = blob.centre[2];
#pragma omp simd
      for (int k = 0; k < lanes; ++k) {
        const double rx = x.x[k] - cx, ry = x.y[k] - cy, rz = x.z[k] - cz;
        const double e = height * wide_exp((rx * rx + ry * ry + rz * rz) * (-steep / 2));
        sum.excess[k] += e;
        sum.gradient.x[k] -= e * steep * rx;
        sum.gradient.y[k] -= e * steep * ry;
        sum.gradient.z[k] -= e * steep * rz;
      }
    }
#pragma omp simd
    for (int k = 0; k < lanes; ++k) sum.excess[k] += background_;
    found = sum;
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

/// Returns the properties of the field. The length over which the index varies (scale) is the width
/// of the narrowest blob.
FieldFacts facts(const GaussianBlobs& field);

struct BlobsValues {
  using Field = GaussianBlobs;
  static constexpr const char* word = "blobs";
  static constexpr bool is_medium = false;
  double index = 1;
  std::string blobs{};
};

void add_keys(Keys& keys, BlobsValues& values);
/// Makes the field from its scene keys. Throws InputError for invalid values.
GaussianBlobs make_field(const Keys& keys, const BlobsValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin

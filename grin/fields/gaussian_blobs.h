#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "grin/index/field_kind.h"

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

/// The narrowest blob sets the scale.
FieldFacts facts(const GaussianBlobs& field);

struct BlobsValues {
  using Field = GaussianBlobs;
  static constexpr const char* word = "blobs";
  static constexpr bool is_medium = false;
  double index = 1;
  std::string blobs{};
};

void add_keys(Keys& keys, BlobsValues& values);
/// Throws InputError.
GaussianBlobs make_field(const Keys& keys, const BlobsValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin

#include "mc/fit/model/neglected.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "mc/theory/allowance.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Sizes of a value's errors and the angle that light is turned by.
struct NeglectedPart {
  double common = 0, own = 0;
  double angle = 0;
};

/// The two shares of what is neglected.
struct NeglectedShares {
  double common, own;

  explicit NeglectedShares(const Scene& scene) {
    const Allowance part(scene);
    common = part.crossed_paths + part.k_shift + part.correlations;
    own = part.near_zone + part.guided;
  }
};

double turned(const Scene& scene, std::size_t entry) {
  const auto& request = scene.request;
  const Channel channel = request.channels[request.entries[entry].a];
  return request.views[channel.view].angle - request.lights[channel.light].angle;
}

NeglectedPart part_of(const Curve& curve, const Medium& medium, std::size_t entry, double value) {
  if (is_flux(curve.observable) || !medium.scene.medium.has_scatterers) return {};
  const NeglectedShares shares(medium.scene);
  if (curve.observable == Observable::intensity)
    return {shares.common * value, shares.own * value, turned(medium.scene, entry)};
  const double still = curve.observable == Observable::squared_contrast ? medium.spec.beta : 1;
  return {(shares.common + shares.own) * (still - value)};
}

/// Of all values of one measurement.
MatrixXd covariance_of(const std::vector<NeglectedPart>& parts, double width) {
  const Index size = std::ssize(parts);
  MatrixXd found(size, size);
  for (Index i = 0; i < size; ++i)
    for (Index j = 0; j < size; ++j) {
      const NeglectedPart &a = parts[static_cast<std::size_t>(i)],
                          &b = parts[static_cast<std::size_t>(j)];
      const double apart = std::remainder(a.angle - b.angle, 2 * std::numbers::pi) / width;
      found(i, j) = a.common * b.common + a.own * b.own * std::exp(-apart * apart / 2);
    }
  return found;
}

/// How fast amplitudes vary with the angle.
double width_of(const Scene& scene) {
  const double size = scene.scatterer.is_disk() ? scene.k * scene.scatterer.radius : 1;
  return 1 / std::max(1.0, size);
}

}  // namespace

MatrixXd neglected_covariance(const FitTask& task, const Media& media, const VectorXd& values) {
  MatrixXd all = MatrixXd::Zero(values.size(), values.size());
  Index first = 0;
  auto medium = media.begin();
  for (const Measurement& one : task.measurements) {
    std::vector<NeglectedPart> parts;
    const double width = width_of(medium->scene);
    for (const Curve& curve : one.curves) {
      for (const std::size_t entry : curve.entries)
        parts.push_back(part_of(curve, *medium, entry, values[first + std::ssize(parts)]));
      ++medium;
    }
    const Index size = std::ssize(parts);
    if (!one.by_paths) all.block(first, first, size, size) = covariance_of(parts, width);
    first += size;
  }
  return all;
}

}  // namespace flatspeckle::mc

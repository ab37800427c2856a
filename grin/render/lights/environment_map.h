#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/numbers/random.h"
#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// L/n^2 of the light that arrives from each direction, constant within the pixels of an
/// equirectangular picture. Rows are equal steps of the angle from `up`, the first row is upmost.
/// Columns are equal steps of azimuth about `up`, to the right as seen from the stage; the
/// direction `centre` is in the middle of the picture.
class EnvironmentMap {
 public:
  /// radiance: [row][column], at least 0 and not 0 everywhere. centre and up must not be parallel.
  EnvironmentMap(std::size_t rows, std::size_t columns, std::vector<double> radiance,
                 const Vec3& centre, const Vec3& up);

  /// L/n^2 of light from the unit direction `from`, which points away from the stage.
  double radiance(const Vec3& from) const;
  /// Returns a direction with a density in proportion to radiance().
  Vec3 sample(RandomStream& random) const;
  /// Density of sample(), per solid angle.
  double density(const Vec3& from) const { return radiance(from) / total_; }
  /// Integral of radiance times a weight over all directions; the weight is taken in the middle of
  /// each pixel.
  double integral(const std::function<double(const Vec3&)>& weight) const;

 private:
  /// Direction at these coordinates of the picture, both from 0 to 1.
  Vec3 direction(double down, double across) const;
  double solid_angle(std::size_t row) const;

  std::size_t rows_, columns_;
  std::vector<double> radiance_;
  Vec3 forward_, right_, up_;
  std::vector<double> power_so_far_;  ///< sums over the pixels of radiance times solid angle
  double total_ = 0;
};

}  // namespace flatspeckle::grin

#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "mc/paths/speckle/camera_sides.h"

namespace flatspeckle::mc {

/// Mean intensity of the fields of a CameraSum over the random phases of its paths,
///   sum_p |c_p A(w_p -> v)|^2 exp(-mu_t d(x_p, v)),
/// at the pixels. It is interpolated by a polynomial of the direction cosines. Interference with
/// reversed paths is not included.
class CameraIntensity {
 public:
  CameraIntensity(const PathWalks& walks, const FarCamera& camera,
                  const CameraResolution& resolution, std::size_t fields);

  /// Adds an end. factors: those in successive fields, the first of which is `field`.
  void add(const PathEnd& end, std::span<const Complex> factors, std::size_t field = 0);
  /// Computes the intensities, [field][y][x].
  void finish(std::span<double> out) const;

 private:
  const PathWalks& walks_;
  FarCamera camera_;
  std::size_t fields_;
  std::vector<double> node_;
  std::unique_ptr<EndpointFactors> factors_;  ///< of the nodes [node y][node x]
  std::vector<Complex> values_;
  std::vector<double> sums_;  ///< [field][node y][node x]
};

}  // namespace flatspeckle::mc

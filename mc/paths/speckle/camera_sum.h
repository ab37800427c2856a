#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/paths/speckle/camera_sides.h"
#include "mc/paths/speckle/spreading_axis.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Sums the far fields of many ends of paths over all pixels of the camera of a box in space,
///   u(v) = sum_p c_p A(w_p -> v) exp(-i k v.x_p - mu_t d(x_p, v) / 2)  (C58, C59),
/// with A divided by sqrt(sigma_s). A and the attenuation up to the face of the box vary slowly
/// with the direction v. They are evaluated at Chebyshev nodes of its direction cosines and
/// interpolated by polynomials. The remaining sums of phases are spread by a smooth kernel on a
/// grid that covers the box; matrix products then give all pixels. CameraSides adds what leaves
/// through the sides of the box. The medium must be homogeneous.
class CameraSum {
 public:
  /// camera: must have the axis and aperture of the camera of the scene of `walks`. fields: number
  /// of sums with different factors c_p of the same ends.
  CameraSum(const PathWalks& walks, const FarCamera& camera, const CameraResolution& resolution,
            std::size_t fields);

  /// Returns the memory for the grids of one field, in bytes.
  static double bytes(const CameraBox& box, const CameraResolution& resolution);

  /// Adds an end. factors: those in successive fields, the first of which is `field`.
  void add(const PathEnd& end, std::span<const Complex> factors, std::size_t field = 0);

  /// Adds the fields to `out`, [field][y][x].
  void finish(std::span<Complex> out);

 private:
  /// Grid in the box.
  struct Grid {
    double z_middle;  ///< middle of the range of v_z
    SpreadingAxis x, y, z;

    Grid(const CameraBox& box, const CameraResolution& resolution);
    std::size_t size() const { return x.size() * y.size() * z.size(); }
  };
  /// Spreads the ends that wait. Ends are spread in the order of their places, so that most of the
  /// grid that they share stays in the processor's cache.
  void flush();
  void spread(const WeightedEnd& weighted);

  const CameraBox box_;
  std::size_t fields_;
  std::vector<double> node_;
  Directions node_directions_;
  Grid grid_;
  std::vector<WeightedEnd> waiting_;
  std::vector<Complex> waiting_factors_;  ///< those of all ends that wait; it never reallocates
  std::vector<Complex> values_, scaled_;  ///< of one end at the nodes, [node y][node x]
  std::vector<Complex> spread_;           ///< [field][z][y][x][node y][node x]
  CameraSides sides_;
};

/// Computes the sums of CameraSum end by end and pixel by pixel.
class DirectCameraSum {
 public:
  DirectCameraSum(const PathWalks& walks, const FarCamera& camera);
  void add(const PathEnd& end, Complex c, std::span<Complex> out);

 private:
  const PathWalks& walks_;
  std::unique_ptr<EndpointFactors> pixels_;
  std::vector<Complex> values_;
};

}  // namespace flatspeckle::mc

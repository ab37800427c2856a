#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Resolution of a CameraSum.
struct CameraResolution {
  std::size_t nodes = 1;  ///< Chebyshev nodes along each side of the camera
  int width = 4;          ///< width of the spreading kernel, in grid points
  double error = 0;       ///< rms over pixels and random ends, relative to the rms field
};

/// Returns the scene with a camera of few pixels, which has the same axis and aperture. Its walks
/// serve all its pixels.
Scene on_coarse_camera(Scene scene);

/// Chooses the cheapest resolution with an error of at most `tolerance`, measured against direct
/// sums of random ends. Returns the finest resolution if none is accurate enough.
CameraResolution camera_resolution(const PathWalks& walks, double tolerance);

/// Sums the far fields of many ends of paths over all pixels of the camera of a box in space,
///   u(v) = sum_p c_p A(w_p -> v) exp(-i k v.x_p - mu_t d(x_p, v) / 2)  (C58, C59),
/// with A divided by sqrt(sigma_s). A and the attenuation up to the face of the box vary slowly
/// with the direction v. They are evaluated at Chebyshev nodes of its direction cosines and
/// interpolated by polynomials. The remaining sums of phases are spread by a smooth kernel on a
/// grid that covers the box; matrix products then give all pixels. Pixels towards which light
/// leaves through a side of the box, which attenuates it less, are corrected one by one. The medium
/// must be homogeneous.
class CameraSum {
 public:
  /// camera: must have the axis and aperture of the camera of the scene of `walks`. fields: number
  /// of sums with different factors c_p of the same ends.
  CameraSum(const PathWalks& walks, const FarCamera& camera, const CameraResolution& resolution,
            std::size_t fields);

  /// Adds an end at x, which light reaches along `arrival`. c: its factor in each field.
  void add(Vec x, Vec arrival, std::span<const Complex> c);

  /// Adds the fields to `out`, [field][y][x].
  void finish(std::span<Complex> out) const;

 private:
  /// Positions of the grid along one axis, and the kernel.
  struct Axis {
    double origin = 0, step = 1;
    std::size_t size = 0;
    int width = 0;

    Axis() = default;
    /// bandwidth: range of the wavenumbers that are summed over.
    Axis(double low, double high, double bandwidth, int kernel_width);
    double at(std::size_t i) const { return origin + step * static_cast<double>(i); }
    /// Computes the kernel at the `width` grid points around x. Returns the index of the first.
    std::size_t spread(double x, std::span<double> weights) const;
    /// Returns the Fourier transform of the kernel, in grid points, at a wavenumber.
    double transform(double wavenumber) const;
  };
  /// Distance from x to the face of the camera, along z.
  double depth_of(Vec x) const { return camera_.axis.z > 0 ? box_.depth - x.z : x.z; }
  /// Adds to the pixels whose rays leave through a side what these have more than with the
  /// attenuation up to the face.
  void correct_sides(Vec x, Vec arrival, std::span<const Complex> c);
  void select_side_pixels(Vec x);
  /// Matrix of interpolation and phases from (node, grid point) to pixels, [pixel][node][point].
  std::vector<Complex> to_pixels(const Axis& axis, double axis_cosine) const;

  const PathWalks& walks_;
  FarCamera camera_;
  Domain box_;
  double k_, mu_t_, z_middle_, least_z_;  ///< z_middle_, least_z_: of the range of |v_z|
  std::size_t nodes_, fields_;
  std::vector<double> node_;  ///< Chebyshev nodes in [-1, 1]
  Directions node_directions_;
  std::vector<Vec> pixel_directions_;
  Axis x_, y_, z_;
  std::vector<Complex> values_;  ///< of one end at the nodes, [node y][node x]
  std::vector<Complex> grid_;    ///< [field][z][y][x][node y][node x]
  std::vector<std::size_t> side_pixels_;
  std::vector<Complex> side_field_;  ///< [field][y][x]
};

/// Computes the sums of CameraSum end by end and pixel by pixel.
class DirectCameraSum {
 public:
  DirectCameraSum(const PathWalks& walks, const FarCamera& camera);
  void add(Vec x, Vec arrival, Complex c, std::span<Complex> out);

 private:
  const PathWalks& walks_;
  std::unique_ptr<EndpointFactors> pixels_;
  std::vector<Complex> values_;
};

}  // namespace flatspeckle::mc

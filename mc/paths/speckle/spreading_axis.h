#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

/// Returns the Chebyshev nodes of the first kind in [-1, 1].
std::vector<double> chebyshev_nodes(std::size_t count);

/// Returns the values at t of the Lagrange polynomials of Chebyshev nodes, by the barycentric
/// formula.
std::vector<double> lagrange(const std::vector<double>& node, double t);

/// Grid along one axis on which phases exp(-i q x) of scattered points x are spread by a smooth
/// kernel (C59), so that sums over them follow from sums over the grid for every wavenumber q of a
/// band.
class SpreadingAxis {
 public:
  static constexpr int widest = 12;

  SpreadingAxis() = default;
  /// low, high: range of the points. bandwidth: width of the band of wavenumbers around 0.
  /// width: number of grid points to which each point is spread, at most `widest`.
  SpreadingAxis(double low, double high, double bandwidth, int width);

  std::size_t size() const { return size_; }
  int width() const { return width_; }
  double at(std::size_t i) const { return origin_ + step_ * static_cast<double>(i); }
  /// Computes the kernel at the `width` grid points around x. Returns the index of the first.
  std::size_t spread(double x, std::span<double> weights) const;
  /// Returns the Fourier transform of the kernel, in grid points, at a wavenumber.
  double transform(double wavenumber) const;
  /// Returns the matrix of interpolation between nodes and of phases from (grid point, node) to the
  /// pixels of a camera, [pixel][point][node]. axis_cosine: component of the axis of the camera.
  std::vector<Complex> to_pixels(const FarCamera& camera, double axis_cosine, double k,
                                 const std::vector<double>& node) const;

  /// Returns the rms error of the spread phases over positions and over the band.
  static double error(int width);

 private:
  double origin_ = 0, step_ = 1;
  std::size_t size_ = 0;
  int width_ = 0;
};

}  // namespace flatspeckle::mc

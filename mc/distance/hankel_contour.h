#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::mc {

/// A detector on the surface: a disk at a distance from the beam, or a ring around the beam.
struct DistanceDetector {
  enum class Kind { disk, ring };

  Kind kind = Kind::disk;
  double distance;  ///< from the axis of the beam to the centre of the disk or of the ring's width
  double extent;    ///< radius of the disk, or width of the ring

  double nearest() const { return distance - (kind == Kind::disk ? extent : extent / 2); }
  double area() const;
  bool operator==(const DistanceDetector&) const = default;
};

/// Inverse Hankel transform from transverse frequencies q to powers on detectors. The integral over
/// real q of R(q) q J_0(q r) is that of R(q) q H_0(q r), whose path is turned into the complex
/// plane: R(q) has no singularity away from the imaginary axis, and there the integrand decays
/// exponentially. Powers are therefore accurate at all distances, however small they are.
class HankelContour {
 public:
  /// source_radius: radius of a uniform beam; 0 for a beam without extent.
  HankelContour(std::span<const DistanceDetector> detectors, double source_radius);

  const std::vector<Complex>& frequencies() const { return frequencies_; }
  /// Returns the weight of a frequency: the power on a detector is the real part of the sum over
  /// the frequencies of R times its weight.
  Complex weight(std::size_t detector, std::size_t frequency) const {
    return weights_[detector][frequency];
  }

 private:
  std::vector<Complex> frequencies_;
  std::vector<std::vector<Complex>> weights_;
};

/// Returns the Hankel functions of the first kind H_0 and H_1 at z in the first quadrant, away from
/// the real axis.
std::array<Complex, 2> hankel_in_quadrant(Complex z);
/// Returns the Bessel function J_1 at complex z.
Complex complex_bessel_j1(Complex z);

}  // namespace flatspeckle::mc

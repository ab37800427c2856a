#pragma once

#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::grin {

/// A homogeneous sphere in a plane wave (conventions, C43).
class MieSphere {
 public:
  /// Of what size() may be: 2 pi radius over the wavelength around it.
  static constexpr double smallest = 1e-6, largest = 1e4;

  /// index: relative, not 0; Im >= 0 absorbs.
  MieSphere(double size, Complex index);

  double size() const { return size_; }
  /// The last order n above rounding.
  int order() const { return static_cast<int>(coefficients_.size()); }

  /// Cross sections over pi radius^2.
  double extinction() const { return extinction_; }
  double scattering() const { return scattering_; }
  /// Of unpolarized light; the sphere scatters.
  double mean_cosine() const { return mean_cosine_; }

  /// Perpendicular and parallel to the plane of scattering, of a turn by its cosine.
  struct Amplitudes {
    Complex s1, s2;
  };
  Amplitudes amplitudes(double cosine) const;

 private:
  struct Coefficients {
    Complex a, b;
  };
  std::vector<Coefficients> coefficients() const;
  void sum();

  double size_;
  Complex index_;
  std::vector<Coefficients> coefficients_;  ///< of n = 1 .. order()
  double extinction_ = 0, scattering_ = 0, mean_cosine_ = 0;
};

}  // namespace flatspeckle::grin

#pragma once

#include <complex>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "flatland/media/faces.h"

namespace flatspeckle::wave {

/// Returns exp(i k d), the phase of a wave of wavenumber k after a distance d.
inline Complex propagated(Complex k, double d) {
  return std::exp(Complex(-k.imag() * d, k.real() * d));
}

/// Plane waves exp(i p x) in an infinite layer 0 <= z <= depth between half-spaces of another
/// refractive index (conventions, C51). p is the transverse wavenumber, equal on both sides of a
/// face, and may be complex with Re p >= 0 >= Im p, or real of either sign.
class LayerWaves {
 public:
  /// k: wavenumber in the layer. depth: thickness of the layer.
  LayerWaves(const Faces& faces, double k, double depth);

  double k() const { return k_; }
  double outside_k() const { return outside_k_; }
  double depth() const { return depth_; }
  /// Returns the factor s with which du/dz inside the layer equals s du/dz outside: 1 in TM, the
  /// square of the relative index of the layer in TE.
  double derivative_ratio() const { return derivative_ratio_; }

  /// Returns the wavenumber along z, with a positive imaginary part if the wave is evanescent.
  Complex inside(Complex p) const;
  Complex outside(Complex p) const;
  /// Returns the amplitude with which a face reflects a wave that arrives from inside.
  Complex reflected(Complex p) const;

  /// Returns the field at a point of the layer under a unit plane wave exp(i k w.r) that arrives
  /// from outside in the direction `angle` (C2, C3).
  Complex illuminated(double angle, Vec point) const;
  /// Returns the amplitude (C4) in the direction `angle` outside of the wave H_0(k |r - point|)
  /// that a point of the layer emits.
  Complex emitted(double angle, Vec point) const;

 private:
  double k_, outside_k_, depth_, derivative_ratio_;
};

}  // namespace flatspeckle::wave

#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "wave_solver/layered/even_table.h"
#include "wave_solver/layered/layer_waves.h"

namespace flatspeckle::wave {

/// The Green function G between points of an infinite layer with reflecting faces, times -4 i
/// (conventions, C51) [chew1995]. In an unbounded medium -4 i G is H_0. The waves that return from
/// the faces are Sommerfeld integrals over the transverse wavenumber, of a function of (x - x', z +
/// z') and one of (x - x', z - z'). Both are tabulated and interpolated. They contain the modes
/// that a layer of higher index guides. Singular parts, due to the mirror image in the nearest
/// face, are closed forms.
class LayerGreen {
 public:
  /// Largest error of the values. It is reached within 1/100 of a wavelength from a face.
  static constexpr double accuracy = 1e-6;

  /// width: upper bound of |x - x'|. Throws InputError if the tables exceed the available memory.
  LayerGreen(const LayerWaves& waves, double width);

  const LayerWaves& waves() const { return waves_; }

  /// Returns -4 i G for two points between the faces. For equal points, returns the part that the
  /// faces reflect, without H_0.
  Complex operator()(Vec p, Vec q) const;

 private:
  struct Node;
  struct Reflections;
  std::vector<Node> contour() const;
  void add_integrals(EvenTable& table, double offset,
                     Complex (Reflections::*wave)(double) const) const;
  void add_regular_images(EvenTable& table) const;
  Complex image(double x, double z) const;

  LayerWaves waves_;
  double width_;
  /// Reflection by a face at large p: mirror_ + curved_ / p^2.
  double mirror_, curved_;
  /// once_: reflected part without image(), against min(z + z', 2 depth - z - z'). corner_: the
  /// same next to the faces, on a finer grid. twice_: part that both faces reflect, against depth -
  /// |z - z'|.
  EvenTable once_, corner_, twice_;
  double corner_size_;
};

}  // namespace flatspeckle::wave

#pragma once

#include <cstddef>
#include <vector>

#include "flatland/media/faces.h"

namespace flatspeckle {

/// Products, of both fields of a pair or of a field with itself, of the amplitudes at a face: of
/// reflection; of transmission in the direction of the light; and of transmission in both
/// directions.
struct FaceProducts {
  double reflected = 1, transmitted = 1, in_and_out = 1;

  /// Returns the fractions of power at a face.
  static FaceProducts of_power(const Face& face, double cosine) {
    const double reflected = face.reflectance(cosine), rest = 1 - reflected;
    return {reflected, rest, rest * rest};
  }
};

/// Amplitudes of a wave, or of the product of two waves, in a stack of layers between faces.
template <typename C>
struct StackAmplitudes {
  std::vector<C> forward;   ///< where the wave enters each layer
  std::vector<C> backward;  ///< where the reflected wave enters each layer, on its way back
  C reflected, transmitted;
};

/// Follows a wave of unit amplitude through a stack of layers, including all reflections between
/// faces. Layers and faces are listed in the direction of the wave. through: factor of the wave
/// across each layer. faces: one more than layers.
template <typename C>
StackAmplitudes<C> amplitudes_in_stack(const std::vector<C>& through,
                                       const std::vector<FaceProducts>& faces) {
  const C one = 1.0 + C{};
  const std::size_t layers = through.size();
  // behind[i]: amplitude reflected by all faces behind layer i, seen from that layer
  std::vector<C> behind(layers);
  C reflected = faces[layers].reflected * one;
  for (std::size_t i = layers; i-- > 0;) {
    behind[i] = reflected;
    const C round = through[i] * through[i] * behind[i];
    reflected =
        faces[i].reflected * one + faces[i].in_and_out * round / (one - faces[i].reflected * round);
  }
  StackAmplitudes<C> found{{}, {}, reflected, one};
  for (std::size_t i = 0; i < layers; ++i) {
    const C round = through[i] * through[i] * behind[i];
    found.forward.push_back(faces[i].transmitted * found.transmitted /
                            (one - faces[i].reflected * round));
    found.backward.push_back(found.forward[i] * through[i] * behind[i]);
    found.transmitted = found.forward[i] * through[i];
  }
  found.transmitted = faces[layers].transmitted * found.transmitted;
  return found;
}

}  // namespace flatspeckle

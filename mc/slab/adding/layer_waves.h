#pragma once

#include <cmath>
#include <vector>

#include "core/algebra/dual.h"
#include "flatland/media/face_stack.h"
#include "mc/slab/adding/pair_wave.h"
#include "mc/slab/adding/slab.h"

namespace flatspeckle::mc {

/// A wave of a pair of illuminations in one layer: the directions there, the wave, and the factor
/// by which the response of the layer to the wave is multiplied.
template <typename Geometry, typename Number>
struct LayerWaveOf {
  PairOf<typename Geometry::Direction> pair;
  PairWaveOf<Number> wave;
  ComplexOf<Number> factor;
};

/// Waves of one layer: the refracted pair and, if the slab has faces, its reflection.
template <typename Geometry, typename Number>
using LayerWavesOf = std::vector<LayerWaveOf<Geometry, Number>>;

/// Follows a pair of illuminations that enters a stack of layers from outside, through faces that
/// reflect and refract (C46). Both fields are reflected the same number of times: products of
/// fields that were reflected differently oscillate with depth and are neglected, with an error of
/// order 1/(k depth).
template <typename Geometry, typename Number>
class PairInLayersOf {
 public:
  using Slab = SlabOf<Geometry, Number>;
  using Pair = PairOf<typename Geometry::Direction>;
  using C = ComplexOf<Number>;

  PairInLayersOf(const Slab& slab, const Pair& outside) : slab_(slab), outside_(outside) {
    for (const auto& layer : slab.layers) {
      const Pair pair = refracted(outside, slab.outside_index / layer.index);
      waves_.push_back({{pair, pair_wave(layer.k / layer.mu_t, pair, slab.departure), C{}}});
    }
    slab.has_faces() ? follow_reflections() : attenuate();
  }

  /// Returns the waves in each layer.
  const std::vector<LayerWavesOf<Geometry, Number>>& layers() const { return waves_; }

 private:
  /// Returns the exponent at the top or the bottom of a layer.
  C exponent(std::size_t layer, C PairWaveOf<Number>::*end) const {
    return slab_.optical_depth(slab_.layers[layer]) * (waves_[layer].front().wave.*end);
  }

  /// Sets the factors without faces: the attenuation in all other layers. A layer as a whole
  /// attenuates a wave from above by exp(top) and a wave from below by exp(bottom).
  void attenuate() {
    using std::exp;
    for (std::size_t l = 0; l < waves_.size(); ++l) {
      C sum{};
      for (std::size_t m = 0; m < waves_.size(); ++m)
        if (m != l)
          sum += exponent(m, m < l ? &PairWaveOf<Number>::top : &PairWaveOf<Number>::bottom);
      waves_[l].front().factor = exp(sum);
    }
  }

  /// Sets the factors with faces. Layers and faces are counted in the direction of the pair, from
  /// the face through which it enters.
  void follow_reflections() {
    using std::exp;
    const std::size_t layers = waves_.size();
    const bool down = cosine_of(outside_.first) > 0;
    const auto at = [&](std::size_t i) { return down ? i : layers - 1 - i; };
    std::vector<C> through;
    std::vector<FaceProducts> faces;
    for (std::size_t i = 0; i <= layers; ++i) faces.push_back(at_face(i, down));
    for (std::size_t i = 0; i < layers; ++i) {
      const C rate =
          exponent(at(i), &PairWaveOf<Number>::top) - exponent(at(i), &PairWaveOf<Number>::bottom);
      through.push_back(down ? exp(rate) : exp(-rate));
    }
    const auto amplitudes = amplitudes_in_stack(through, faces);
    const C phase = entering_phase(down);
    for (std::size_t i = 0; i < layers; ++i)
      set_factors(at(i), down, phase * amplitudes.forward[i], phase * amplitudes.backward[i]);
  }

  /// Returns the products of the amplitudes of both fields at face i.
  FaceProducts at_face(std::size_t i, bool down) const {
    const auto l = static_cast<std::ptrdiff_t>(i), layers = std::ssize(slab_.layers);
    const Face face =
        down ? slab_.face(l)
             : Face{slab_.index(layers - l), slab_.index(layers - l - 1), slab_.polarisation};
    FaceProducts found;
    for (const auto& direction : {outside_.first, outside_.second}) {
      const double cosine =
                       std::abs(cosine_of(refracted(direction, slab_.outside_index / face.from))),
                   amplitude = face.reflected(cosine);
      found.reflected *= amplitude;
      found.transmitted *= 1 + amplitude;
      found.in_and_out *= (1 + amplitude) * (1 - amplitude);
    }
    return found;
  }

  /// Returns the factor of a pair at the face through which it enters. The phase of a wave outside
  /// is 0 at z = 0.
  C entering_phase(bool down) const {
    const double along =
        cosine_of(outside_.first) - (1 + slab_.departure.shift) * cosine_of(outside_.second);
    return Complex(std::polar(1.0, down ? 0 : slab_.k * slab_.depth * along)) * (1.0 + C{});
  }

  /// Sets the factors of the waves of a layer. forward, backward: amplitudes of the pair and of its
  /// reflection where they enter the layer.
  void set_factors(std::size_t l, bool down, const C& forward, const C& backward) {
    using std::exp;
    const auto& layer = slab_.layers[l];
    const double scale =
        Geometry::radiance_scale(layer.index / slab_.outside_index, slab_.polarisation);
    auto& waves = waves_[l];
    // The mirror image of a wave has the same form, with top and bottom exchanged.
    const auto first = waves.front();
    waves.push_back({mirrored(first.pair), {first.wave.bottom, first.wave.top}, C{}});
    const auto at_entry = [&](const PairWaveOf<Number>& wave, bool from_top) {
      return exp(slab_.optical_depth(layer) * (from_top ? wave.bottom : wave.top));
    };
    waves[0].factor = scale * (forward / at_entry(waves[0].wave, down));
    waves[1].factor = scale * (backward / at_entry(waves[1].wave, !down));
  }

  const Slab& slab_;
  Pair outside_;
  std::vector<LayerWavesOf<Geometry, Number>> waves_;
};

}  // namespace flatspeckle::mc

#pragma once

#include <memory>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/transport/scattering_matrices.h"

namespace flatspeckle::mc {

/// A layer as a slab of its own.
struct OneLayer {
  Scene scene;
  std::shared_ptr<const ScatteringLaw> law;

  double depth() const { return scene.medium.mu_t * scene.domain.depth; }
};

/// Of a slab of Layers, of which one at the least scatters; the law of those that do not is that of
/// one that does. delay: of scatterers that diffuse as the scene states, of which a layer has its
/// share.
std::vector<OneLayer> layers_of(const Scene& slab, double delay = 0);

/// What grids are made for.
const ScatteringLaw& narrowest_law(const std::vector<OneLayer>& layers);
int least_order(const std::vector<OneLayer>& layers);

/// What the layers above and below leave of waves where they enter each layer, of [layer][wave];
/// top and bottom: exponents of a layer as a whole, by layer and wave.
template <typename TopOf, typename BottomOf>
std::vector<std::vector<Complex>> entering(std::size_t layers, std::size_t waves, const TopOf& top,
                                           const BottomOf& bottom) {
  std::vector<std::vector<Complex>> factors(layers, std::vector<Complex>(waves));
  for (std::size_t w = 0; w < waves; ++w)
    for (std::size_t l = 0; l < layers; ++l) {
      Complex exponent = 0;
      for (std::size_t m = 0; m < layers; ++m)
        if (m != l) exponent += m < l ? top(m, w) : bottom(m, w);
      factors[l][w] = std::exp(exponent);
    }
  return factors;
}

/// A layer each; they refer to the grid.
using LayerMatrices = std::vector<std::unique_ptr<ScatteringMatrices>>;
LayerMatrices layer_matrices(const std::vector<OneLayer>& layers, const AngularGrid& grid);

/// q: transverse momentum, per length.
std::vector<StackedLayer> stacked(const std::vector<OneLayer>& layers,
                                  const LayerMatrices& matrices, double q,
                                  const std::vector<Pair>& lights, const std::vector<Pair>& views,
                                  Parity parity);

}  // namespace flatspeckle::mc

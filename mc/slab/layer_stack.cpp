#include "mc/slab/layer_stack.h"

#include <algorithm>
#include <utility>

#include "flatland/media/layers.h"

namespace flatspeckle::mc {

namespace {

Scene slab_of(const Scene& whole, const Layers& layers, std::size_t layer) {
  Scene own = whole;
  own.profile.reset();
  own.scatterer = layers.materials()[layer].scatterer;
  own.medium = layers.materials()[layer].medium;
  own.domain.depth = layers.thickness(layer);
  return own;
}

}  // namespace

std::vector<OneLayer> layers_of(const Scene& slab, double delay) {
  const auto& layers = dynamic_cast<const Layers&>(*slab.profile);
  std::vector<OneLayer> list;
  std::shared_ptr<const ScatteringLaw> any;
  for (std::size_t l = 0; l < layers.materials().size(); ++l) {
    list.push_back({slab_of(slab, layers, l), nullptr});
    if (list[l].scene.medium.mu_s > 0)
      any = list[l].law = std::make_shared<const ScatteringLaw>(
          list[l].scene, delay * layers.materials()[l].motion.diffusion);
  }
  for (OneLayer& layer : list)
    if (!layer.law) layer.law = any;
  return list;
}

const ScatteringLaw& narrowest_law(const std::vector<OneLayer>& layers) {
  return *std::ranges::min_element(layers, {}, [](const OneLayer& layer) {
            return layer.law->width();
          })->law;
}

int least_order(const std::vector<OneLayer>& layers) {
  int order = 0;
  for (const OneLayer& layer : layers) order = std::max(order, layer.law->least_order());
  return order;
}

LayerMatrices layer_matrices(const std::vector<OneLayer>& layers, const AngularGrid& grid) {
  LayerMatrices matrices;
  for (const OneLayer& layer : layers)
    matrices.push_back(
        std::make_unique<ScatteringMatrices>(grid, *layer.law, layer.scene.medium.albedo));
  return matrices;
}

std::vector<StackedLayer> stacked(const std::vector<OneLayer>& layers,
                                  const LayerMatrices& matrices, double q,
                                  const std::vector<Pair>& lights, const std::vector<Pair>& views,
                                  Parity parity) {
  std::vector<StackedLayer> parts;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    auto ends = matrices[l]->ends(layers[l].scene, lights, views, parity);
    parts.push_back({matrices[l]->transport(q / layers[l].scene.medium.mu_t, parity),
                     layers[l].depth(),
                     std::move(ends.lights),
                     std::move(ends.views),
                     {},
                     {}});
  }
  const auto factors = [&](auto ends) {
    return entering(
        parts.size(), (parts.front().*ends).top.size(),
        [&](std::size_t l, std::size_t w) { return parts[l].depth * (parts[l].*ends).top[w]; },
        [&](std::size_t l, std::size_t w) { return parts[l].depth * (parts[l].*ends).bottom[w]; });
  };
  const auto of_lights = factors(&StackedLayer::lights), of_views = factors(&StackedLayer::views);
  for (std::size_t l = 0; l < parts.size(); ++l) {
    parts[l].light_factors = of_lights[l];
    parts[l].view_factors = of_views[l];
  }
  return parts;
}

}  // namespace flatspeckle::mc

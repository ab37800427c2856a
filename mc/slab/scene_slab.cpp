#include "mc/slab/scene_slab.h"

#include <optional>
#include <utility>
#include <vector>

#include "flatland/media/layers.h"
#include "mc/slab/adding/plane.h"
#include "mc/slab/adding/space.h"

namespace flatspeckle::mc {

namespace {

Scene slab_of_layer(Scene scene, const Material& material) {
  scene.profile.reset();
  scene.scatterer = material.scatterer;
  scene.medium = material.medium;
  return scene;
}

/// Returns the layers of a scene. A layer that does not scatter is given the scattering law of one
/// that does.
template <typename Geometry>
std::vector<SlabLayerOf<Geometry, double>> layers_of(const Scene& scene, const Layers& layers,
                                                     double delay) {
  const auto& materials = layers.materials();
  std::vector<std::optional<typename Geometry::Law>> laws;
  std::optional<typename Geometry::Law> any;
  for (const Material& material : materials) {
    laws.emplace_back();
    if (material.medium.mu_s > 0)
      any = laws.back() =
          Geometry::law(slab_of_layer(scene, material), delay * material.motion.diffusion);
  }
  std::vector<SlabLayerOf<Geometry, double>> list;
  for (std::size_t l = 0; l < laws.size(); ++l)
    list.push_back({materials[l].medium.mu_t, layers.thickness(l), materials[l].medium.albedo,
                    laws[l] ? *laws[l] : *any,
                    scene.faces ? scene.k * (materials[l].index / scene.faces->inside) : scene.k,
                    materials[l].index});
  return list;
}

}  // namespace

template <typename Geometry>
SlabOf<Geometry, double> slab_of(const Scene& scene, double delay) {
  const BulkMedium& medium = scene.medium;
  const double depth = scene.domain.depth;
  const Faces faces = scene.faces.value_or(Faces{});
  std::vector<SlabLayerOf<Geometry, double>> list;
  if (const auto* layers = dynamic_cast<const Layers*>(scene.profile.get()))
    list = layers_of<Geometry>(scene, *layers, delay);
  else
    list = {
        {medium.mu_t, depth, medium.albedo, Geometry::law(scene, delay), scene.k, faces.inside}};
  return {scene.outside_k(), medium.mu_t,       depth, std::move(list), {},
          faces.outside,     faces.polarisation};
}

template SlabOf<PlaneGeometry, double> slab_of<PlaneGeometry>(const Scene&, double);
template SlabOf<SpaceGeometry, double> slab_of<SpaceGeometry>(const Scene&, double);

}  // namespace flatspeckle::mc

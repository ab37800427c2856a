#pragma once

#include <memory>
#include <vector>

#include "core/keys/csv.h"
#include "flatland/media/layers.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

/// The file of the key `layers`: a line for each layer, from z = 0 on, with its thickness, one of
/// optical_depth, mean_free_path and density, and whatever keys of the scatterers differ between
/// layers (g, albedo, radius, index_re and index_im, phase_shift); and of motion shares of the
/// scene's, diffusion and flow.
class LayerTable {
 public:
  /// Reads the key and the file. Throws InputError.
  LayerTable(const Keys& keys, const SceneSpec& spec);

  /// Of all layers.
  double depth() const;
  /// Throws InputError that names the line of a layer that cannot be.
  std::shared_ptr<const Layers> layers(const SceneSpec& spec) const;

 private:
  void refuse_twice(const Keys& keys, const SceneSpec& spec) const;
  Material material(const SceneSpec& spec, std::size_t layer) const;

  std::string path_;
  Table table_;
};

}  // namespace flatspeckle

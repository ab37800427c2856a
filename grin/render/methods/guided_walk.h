#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "grin/render/distant/distance_importance.h"
#include "grin/render/distant/level_layers.h"
#include "grin/render/methods/path_kernels.h"
#include "grin/render/methods/render_scene.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// Guides light paths of level layers to sensors far from the light (DistanceImportance).
///
/// Layers, phase functions and a light along their normal are symmetric about the axis through the
/// start of a path. A path that stays closer to the axis than the sides of the stage can therefore
/// be turned about the axis, and the mean over all turns replaces its contribution. Longer paths
/// contribute as they are, and all paths if sound tags them.
class PathGuide {
 public:
  /// Returns nullopt unless the stage is of level layers, at least a transport mean free path
  /// thick, the index is constant in each of them, there is one light, a beam or fibre along their
  /// normal, all sensors are disks on the first or last plane, and at most this share of the paths
  /// would reach some sensor.
  static std::optional<PathGuide> of(const RenderScene& scene, double most_share = 0.02);

  /// A sensor in coordinates of the layers.
  struct Disk {
    PixelRings rings;
    double x, y;          ///< centre, without its height
    double sine_squared;  ///< of the largest accepted angle
    int first_pixel;
    bool is_last;  ///< whether it is on the last plane
  };

  const LevelLayers& layers() const { return layers_; }
  const DistanceImportance& importance() const { return importance_; }
  const std::vector<Disk>& disks() const { return disks_; }

 private:
  PathGuide(LevelLayers layers, std::vector<Disk> disks, DistanceImportance importance)
      : layers_(std::move(layers)), disks_(std::move(disks)), importance_(std::move(importance)) {}

  LevelLayers layers_;
  std::vector<Disk> disks_;
  DistanceImportance importance_;
};

/// Forward tracing of guided paths: free flights and turns are sampled in proportion to the
/// importance, to first order in its gradient [dwivedi1982]; paths are split and terminated by
/// it (weight window). Unscattered light of beams is left out (unscattered_beams.h).
PathKernel guided_kernel(std::shared_ptr<const PathGuide> guide,
                         std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space);

}  // namespace flatspeckle::grin

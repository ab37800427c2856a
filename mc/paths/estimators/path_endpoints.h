#pragma once

#include <memory>

#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Lights and views as endpoints of paths (C14), for all scorers. Values is the type of the data
/// that a scorer keeps for a list of endpoints.
template <typename Values>
class PathEndpoints {
 public:
  /// scene: must have the medium of the walks. values(n): returns the data of a list of n
  /// endpoints.
  template <typename MakeValues>
  PathEndpoints(const PathWalks& walks, const Scene& scene, bool phases, MakeValues values)
      : reversed_(walks.plan().reversed),
        lights_(&scene == &walks.scene() ? walks.factors(scene, walks.lights(), phases)
                                         : walks.factors(scene, light_endpoints(scene), phases)),
        views_(&scene == &walks.scene() ? walks.factors(scene, walks.views(), phases)
                                        : walks.factors(scene, view_endpoints(scene), phases)),
        light_first(values(lights_->size())),
        light_last(light_first),
        view_first(values(views_->size())),
        view_last(view_first) {}
  template <typename MakeValues>
  PathEndpoints(const PathWalks& walks, MakeValues values)
      : PathEndpoints(walks, walks.scene(), walks.plan().phases || walks.plan().reversed, values) {}

  bool reversed() const { return reversed_; }
  EndpointFactors& lights() { return *lights_; }
  EndpointFactors& views() { return *views_; }

  void choose(FaceWaves waves) {
    lights_->choose(waves.light);
    views_->choose(waves.view);
  }

  /// Updates the values for a path. at(endpoints, x, arrival, values) must compute the values for
  /// light that reaches x along `arrival` and is scattered towards the endpoints. Values at the
  /// first scatterer are computed only if the start of the path has changed. Those of the lights at
  /// the last scatterer (light_last) and of the views at the first (view_first) are computed only
  /// for reversed paths.
  template <typename At>
  void find(const Path& path, At at) {
    choose(path.waves);
    if (path.new_start) {
      at(*lights_, path.first, -path.start, light_first);
      if (reversed_) at(*views_, path.first, -path.start, view_first);
    }
    at(*views_, path.last, path.arrival, view_last);
    if (reversed_) at(*lights_, path.last, path.arrival, light_last);
  }

 private:
  bool reversed_;
  std::unique_ptr<EndpointFactors> lights_, views_;

 public:
  Values light_first, light_last, view_first, view_last;
};

}  // namespace flatspeckle::mc

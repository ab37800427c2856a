#pragma once

#include <memory>

#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Lights and views at the two ends of paths (C14), where every scorer begins. Values: what it
/// keeps of a list of ends.
template <typename Values>
class PathEnds {
 public:
  /// Of a scene with the same medium as that of the walks; values(n): of n ends.
  template <typename MakeValues>
  PathEnds(const PathWalks& walks, const Scene& scene, bool phases, MakeValues values)
      : reversed_(walks.plan().reversed),
        lights_(walks.factors(scene, light_ends(scene), phases)),
        views_(walks.factors(scene, view_ends(scene), phases)),
        light_first(values(lights_->size())),
        light_last(light_first),
        view_first(values(views_->size())),
        view_last(view_first) {}
  template <typename MakeValues>
  PathEnds(const PathWalks& walks, MakeValues values)
      : PathEnds(walks, walks.scene(), walks.plan().phases || walks.plan().reversed, values) {}

  bool reversed() const { return reversed_; }
  EndFactors& lights() { return *lights_; }
  EndFactors& views() { return *views_; }

  /// at(ends, x, arrival, values): finds what light that reaches x along `arrival` is to the ends.
  /// Those of the first scatterer are kept as long as it stays; light_last and view_first only
  /// matter to reversed paths.
  template <typename At>
  void find(const Path& path, At at) {
    if (path.new_start) {
      at(*lights_, path.first, -path.start, light_first);
      if (reversed_) at(*views_, path.first, -path.start, view_first);
    }
    at(*views_, path.last, path.arrival, view_last);
    if (reversed_) at(*lights_, path.last, path.arrival, light_last);
  }

 private:
  bool reversed_;
  std::unique_ptr<EndFactors> lights_, views_;

 public:
  Values light_first, light_last, view_first, view_last;
};

}  // namespace flatspeckle::mc

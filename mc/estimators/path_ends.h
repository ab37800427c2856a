#pragma once

#include "mc/ends/end_factors.h"
#include "mc/walk/path_walk.h"

namespace flatspeckle::mc {

/// Lights and views at the two ends of paths (C14), where every scorer begins. Values: what it
/// keeps of a list of ends.
template <typename Values, bool reversed, bool phases>
struct PathEnds {
  using Ends = EndFactors<phases>;

  Ends lights, views;
  Values light_first, light_last, view_first, view_last;

  /// values: of so many ends.
  template <typename MakeValues>
  PathEnds(const Scene& scene, MakeValues values)
      : lights(scene, light_ends(scene)),
        views(scene, view_ends(scene)),
        light_first(values(lights.size())),
        light_last(light_first),
        view_first(values(views.size())),
        view_last(view_first) {}

  /// at(ends, x, arrival, values): finds what light that reaches x along `arrival` is to the ends.
  /// Those of the first scatterer are kept as long as it stays; light_last and view_first only
  /// matter to reversed paths.
  template <typename Direction, typename At>
  void find(const Path<Direction>& path, At at) {
    if (path.new_start) {
      at(lights, path.first, -path.start, light_first);
      if constexpr (reversed) at(views, path.first, -path.start, view_first);
    }
    at(views, path.last, path.arrival, view_last);
    if constexpr (reversed) at(lights, path.last, path.arrival, light_last);
  }
};

}  // namespace flatspeckle::mc

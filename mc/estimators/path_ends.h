#pragma once

#include <type_traits>

#include "mc/ends/end_factors.h"
#include "mc/graded/graded_ends.h"
#include "mc/walk/path_walk.h"

namespace flatspeckle::mc {

/// End factors, straight or bent.
template <typename Scattering, bool phases>
using EndsOf = std::conditional_t<bends<Scattering>, GradedEnds<phases>, EndFactors<phases>>;

template <typename Ends, typename Scattering>
Ends made_ends(const Scene& scene, const std::vector<End>& ends, const Scattering& scattering) {
  if constexpr (bends<Scattering>)
    return Ends(scene, ends, scattering.medium());
  else
    return Ends(scene, ends);
}

/// Lights and views at the two ends of paths (C14), where every scorer begins. Values: what it
/// keeps of a list of ends.
template <typename Values, bool reversed, typename Ends>
struct PathEndsOf {
  Ends lights, views;
  Values light_first, light_last, view_first, view_last;

  /// values: of so many ends.
  template <typename Scattering, typename MakeValues>
  PathEndsOf(const Scene& scene, const Scattering& scattering, MakeValues values)
      : lights(made_ends<Ends>(scene, light_ends(scene), scattering)),
        views(made_ends<Ends>(scene, view_ends(scene), scattering)),
        light_first(values(lights.size())),
        light_last(light_first),
        view_first(values(views.size())),
        view_last(view_first) {}
  /// Straight ones.
  template <typename MakeValues>
  PathEndsOf(const Scene& scene, MakeValues values)
      : PathEndsOf(scene, IsotropicScattering(), values) {}

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

template <typename Values, bool reversed, bool phases>
using PathEnds = PathEndsOf<Values, reversed, EndFactors<phases>>;

}  // namespace flatspeckle::mc

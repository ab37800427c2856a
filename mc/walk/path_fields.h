#pragma once

#include <vector>

#include "flatland/scene/scene.h"
#include "mc/ends/end_factors.h"
#include "mc/walk/accumulator.h"
#include "mc/walk/path_walk.h"

namespace flatspeckle::mc {

/// The field f of every channel on the paths that a walk finds (C14), for an accumulator.
template <typename Scattering, bool reversed, bool near, bool phases>
class PathFields {
 public:
  PathFields(const Scene& scene, const Scattering& scattering, Accumulator& accumulator)
      : scattering_(scattering),
        channels_(scene.request.channels),
        accumulator_(accumulator),
        lights_(scene, light_ends(scene)),
        views_(scene, view_ends(scene)),
        light_first_(lights_.size()),
        light_last_(lights_.size()),
        view_first_(views_.size()),
        view_last_(views_.size()),
        field_(channels_.size()) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) {
    lights_.attenuate(x, light_last_);
    views_.attenuate(x, view_last_);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] = product(product(light_last_[i], view_last_[v]),
                          scattering_.amplitude(-lights_.direction(i), views_.direction(v)));
    }
    accumulator_.add(weight, field_);
  }

  void multiple(const Path& path) {
    if (path.new_start) {
      lights_.at(path.first, -path.start, scattering_, light_first_);
      if constexpr (reversed) views_.at(path.first, -path.start, scattering_, view_first_);
    }
    views_.at(path.last, path.arrival, scattering_, view_last_);
    if constexpr (reversed) lights_.at(path.last, path.arrival, scattering_, light_last_);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] = product(light_first_[i], view_last_[v]);
      if constexpr (reversed) field_[c] += product(light_last_[i], view_first_[v]);
    }
    accumulator_.add(path.weight, field_);
  }

 private:
  const Scattering& scattering_;
  const std::vector<Channel>& channels_;
  Accumulator& accumulator_;
  EndFactors<near, phases> lights_, views_;
  std::vector<Complex> light_first_, light_last_;  ///< A e of every light at the path's ends
  std::vector<Complex> view_first_, view_last_;    ///< of every view
  std::vector<Complex> field_;                     ///< per channel
};

}  // namespace flatspeckle::mc

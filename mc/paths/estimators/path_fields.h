#pragma once

#include <span>
#include <vector>

#include "core/numbers/phasor.h"
#include "mc/paths/estimators/path_ends.h"

namespace flatspeckle::mc {

/// Whether channels are every light in every view, [light][view].
inline bool is_grid(const std::vector<Channel>& channels, std::size_t lights, std::size_t views) {
  if (channels.size() != lights * views) return false;
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (channels[c].light != c / views || channels[c].view != c % views) return false;
  return true;
}

/// The field f of every channel that a path makes (C14).
class PathFields {
 public:
  PathFields(const PathWalks& walks, const Scene& scene, bool phases)
      : walks_(walks),
        channels_(scene.request.channels),
        ends_(walks, scene, phases, [](std::size_t ends) { return std::vector<Complex>(ends); }),
        is_grid_(is_grid(channels_, ends_.lights().size(), ends_.views().size())),
        field_(channels_.size()) {}

  /// B = 1 at x.
  std::span<const Complex> single(Vec2 x) {
    ends_.lights().attenuate(x, ends_.light_last);
    ends_.views().attenuate(x, ends_.view_last);
    is_grid_ ? find_rows(x) : find_listed(x);
    return field_;
  }

  std::span<const Complex> multiple(const Path& path) {
    ends_.find(path, [this](EndFactors& ends, Vec2 x, const SpaceDirection& arrival, auto& out) {
      ends.attenuate(x, out);
      walks_.towards(x, arrival, ends.directions(), out);
    });
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] = product(ends_.light_first[i], ends_.view_last[v]);
    }
    if (!ends_.reversed()) return field_;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] += product(ends_.light_last[i], ends_.view_first[v]);
    }
    return field_;
  }

 private:
  /// Of single scattering: each light into all views, a loop of vectors.
  void find_rows(Vec2 x) {
    const auto& view = ends_.view_last;
    for (std::size_t i = 0; i < ends_.lights().size(); ++i) {
      const std::span<Complex> row(&field_[i * view.size()], view.size());
      for (std::size_t v = 0; v < row.size(); ++v) row[v] = product(ends_.light_last[i], view[v]);
      walks_.towards(x, -ends_.lights().direction(i), ends_.views().directions(), row);
    }
  }
  void find_listed(Vec2 x) {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] =
          product(product(ends_.light_last[i], ends_.view_last[v]),
                  walks_.amplitude(x, -ends_.lights().direction(i), ends_.views().direction(v)));
    }
  }

  const PathWalks& walks_;
  const std::vector<Channel>& channels_;
  PathEnds<std::vector<Complex>> ends_;  ///< A e of every end
  bool is_grid_;                         ///< rows of views, a light each
  std::vector<Complex> field_;           ///< per channel
};

}  // namespace flatspeckle::mc

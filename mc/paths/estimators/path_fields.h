#pragma once

#include <span>
#include <vector>

#include "core/numbers/phasor.h"
#include "mc/paths/estimators/path_endpoints.h"

namespace flatspeckle::mc {

/// Whether the channels are all combinations of a light and a view, in the order [light][view].
inline bool is_grid(const std::vector<Channel>& channels, std::size_t lights, std::size_t views) {
  if (channels.size() != lights * views) return false;
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (channels[c].light != c / views || channels[c].view != c % views) return false;
  return true;
}

/// Computes the field f of a path in every channel: F, or F + R with reversed paths (C14).
class PathFields {
 public:
  PathFields(const PathWalks& walks, const Scene& scene, bool phases)
      : walks_(walks),
        channels_(scene.request.channels),
        endpoints_(walks, scene, phases,
                   [](std::size_t endpoints) { return std::vector<Complex>(endpoints); }),
        is_grid_(is_grid(channels_, endpoints_.lights().size(), endpoints_.views().size())),
        field_(channels_.size()) {}

  /// Returns the fields of the path of one scatterer at x.
  std::span<const Complex> single(Vec x, FaceWaves waves) {
    endpoints_.choose(waves);
    endpoints_.lights().attenuate(x, endpoints_.light_last);
    endpoints_.views().attenuate(x, endpoints_.view_last);
    is_grid_ ? find_rows(x) : find_listed(x);
    return field_;
  }

  std::span<const Complex> multiple(const Path& path) {
    endpoints_.find(path, [this](EndpointFactors& endpoints, Vec x, Vec arrival, auto& out) {
      endpoints.attenuate(x, out);
      walks_.towards(x, arrival, endpoints.directions(), out);
    });
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] = product(endpoints_.light_first[i], endpoints_.view_last[v]);
    }
    if (!endpoints_.reversed()) return field_;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] += product(endpoints_.light_last[i], endpoints_.view_first[v]);
    }
    return field_;
  }

 private:
  /// Computes single scattering of each light into all views, in a vectorised loop.
  void find_rows(Vec x) {
    const auto& view = endpoints_.view_last;
    for (std::size_t i = 0; i < endpoints_.lights().size(); ++i) {
      const std::span<Complex> row(&field_[i * view.size()], view.size());
      for (std::size_t v = 0; v < row.size(); ++v)
        row[v] = product(endpoints_.light_last[i], view[v]);
      walks_.towards(x, -endpoints_.lights().direction(i), endpoints_.views().directions(), row);
    }
  }
  void find_listed(Vec x) {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] = product(
          product(endpoints_.light_last[i], endpoints_.view_last[v]),
          walks_.amplitude(x, -endpoints_.lights().direction(i), endpoints_.views().direction(v)));
    }
  }

  const PathWalks& walks_;
  const std::vector<Channel>& channels_;
  PathEndpoints<std::vector<Complex>> endpoints_;  ///< product A e of C14 for every endpoint
  bool is_grid_;                                   ///< true if is_grid(): all pairs [light][view]
  std::vector<Complex> field_;                     ///< field of each channel
};

}  // namespace flatspeckle::mc

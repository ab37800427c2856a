#pragma once

#include <array>
#include <span>

#include "core/numbers/random.h"
#include "grin/render/transport/path_vertex.h"

namespace flatspeckle::grin {

/// Vertices of a light path, kept to be joined: all of a short path, of a long one some, each with
/// the same chance (reservoir sampling), so that joins cost in proportion to a path's length.
class LightVertices {
 public:
  static constexpr int capacity = 8;

  void clear() { offered_ = 0; }

  void offer(const PathVertex& vertex, RandomStream& random) {
    const auto place =
        offered_ < capacity ? offered_ : static_cast<int>(random.uniform() * (offered_ + 1));
    if (place < capacity) vertices_[place] = vertex;
    ++offered_;
  }

  std::span<const PathVertex> kept() const {
    return {vertices_.data(), static_cast<std::size_t>(std::min(offered_, capacity))};
  }
  /// Vertices of the path that each of the kept stands for.
  double each_stands_for() const { return std::max(1.0, static_cast<double>(offered_) / capacity); }

 private:
  std::array<PathVertex, capacity> vertices_;
  int offered_ = 0;
};

}  // namespace flatspeckle::grin

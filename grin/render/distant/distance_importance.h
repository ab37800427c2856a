#pragma once

#include <array>
#include <vector>

#include "grin/render/distant/level_layers.h"
#include "grin/render/transport/field_decay.h"

namespace flatspeckle::grin {

/// A ring on the first or on the last plane of layers; a disk if `inner` is 0. Its centre is at
/// `distance` from the axis, along which light starts.
struct RingTarget {
  double distance, inner, outer;
  bool is_last;  ///< whether it is on the last plane

  /// Returns the share of a circle of radius r about the axis that is on the ring.
  double share(double r) const;
};

/// Importance of light for rings far from the place where it starts, by diffusion in layers. It is
/// symmetric about the axis, as if each ring surrounded it with the share of its circles as
/// sensitivity: walks need not find the azimuth of the sensor. All rings, and the field
/// correlation after some delays, have the same weight: the importance is the sum over them of
/// that of each, divided by its value where light starts.
class DistanceImportance {
 public:
  static constexpr std::size_t most_delays = 4;
  /// Decay of the field correlation so far, by delay.
  using Decays = std::array<double, most_delays>;

  /// start: the light's position; its direction is along the axis. decay: may be null. cells:
  /// largest number of cells along an axis of the grid.
  DistanceImportance(const LevelLayers& layers, const std::vector<RingTarget>& targets,
                     const Vec3& start, bool goes_up, const FieldDecay* decay, int cells);

  /// Approximate share of the light that reaches the target of least light.
  double least_share() const { return least_share_; }

  std::size_t delays() const { return delays_.size(); }
  /// Returns the decays of a path. transfer: sum of 1 - cos, weighted by the diffusion of each
  /// part.
  Decays decays(double transfer) const {
    Decays factors{1};
    for (std::size_t i = 1; i < delays_.size(); ++i)
      factors[i] = std::exp(-2 * delays_[i] * transfer);
    return factors;
  }

  struct Value {
    double value;
    Vec3 log_gradient;
  };
  /// x: relative to the axis.
  Value at(const Vec3& x, const Decays& decays) const;

 private:
  struct Grid {
    double width, height, low;  ///< size of a cell, and coordinate of the first plane
    int columns, rows;
  };

  double& node(int row, int column, std::size_t delay) {
    return nodes_[(static_cast<std::size_t>(row) * grid_.columns + column) * delays_.size() +
                  delay];
  }
  std::vector<std::vector<double>> solve(const LevelLayers& layers,
                                         const std::vector<RingTarget>& targets,
                                         const std::vector<double>& absorptions) const;

  Grid grid_;
  std::vector<double> delays_{0};
  std::vector<double> nodes_;  ///< [row][column][delay], in the middle of the cells
  double least_share_ = 1;
};

}  // namespace flatspeckle::grin

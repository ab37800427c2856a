#pragma once

#include <functional>
#include <vector>

#include "mc/paths/bent/graded_medium.h"

namespace flatspeckle::mc {

/// A wave tabulated over a box: its eikonal by bicubic Hermite interpolation of values and
/// directions, its amplitude by cubic convolution.
class WaveTable : public Wavefront {
 public:
  /// What a place of the table holds. at(x, guess): the arrival there, and n; guess is that of a
  /// place beside it. Throws InputError where a place has none.
  struct Node {
    Arrival arrival;
    double index;
  };
  using At = std::function<std::optional<Node>(Vec2 x, const Node* guess)>;
  /// spreads: from a point, so that the amplitude falls about as path^(-1/2).
  WaveTable(const Domain& box, double spacing, bool spreads, const At& at,
            const std::string& whose);

  std::optional<Arrival> at(Vec2 x) const override;

 private:
  struct Entry {
    double path, by_x, by_z, by_both, log_amplitude, inside_per_chord, launch;
  };
  const Entry& entry(std::size_t i, std::size_t j) const { return entries_[j * columns_ + i]; }
  void find_mixed_derivatives();

  Domain box_;
  bool spreads_;
  Vec2 origin_;
  double dx_, dz_;
  std::size_t columns_, rows_;  ///< one more than the box on each side
  std::vector<Entry> entries_;
};

}  // namespace flatspeckle::mc

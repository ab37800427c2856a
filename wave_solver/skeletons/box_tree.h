#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flatland/media/domain.h"

namespace flatspeckle::wave {

/// What is sorted into boxes: a disk, or a point of radius 0, that carries some unknowns.
struct SortedDisk {
  Vec2 centre;
  double radius = 0;
  std::size_t unknowns = 1;
};

/// Boxes over disks, each halved across its longer side until few unknowns are left in it. A box is
/// shrunk to the centres that it holds before it is halved, so that clusters cost no levels. Two
/// halves at a time, not the four of a quadtree: eliminating twice at half the way costs about half
/// of eliminating once, and less memory.
class BoxTree {
 public:
  struct Box {
    Rectangle hull;                   ///< of its disks, rims included
    std::size_t first = 0, last = 0;  ///< its disks are order()[first .. last - 1]
    std::size_t child = 0;            ///< the first of its two; 0 for a leaf
    std::size_t level = 0;            ///< 0 is the root

    bool is_leaf() const { return child == 0; }
  };

  /// leaf_unknowns: what a leaf may hold; disks of one common centre stay together.
  BoxTree(std::span<const SortedDisk> disks, std::size_t leaf_unknowns);

  /// Level by level from the root, the halves of a box side by side; empty without disks.
  const std::vector<Box>& boxes() const { return boxes_; }
  std::size_t levels() const { return level_.size() - 1; }
  std::size_t level_begin(std::size_t level) const { return level_[level]; }
  std::size_t level_end(std::size_t level) const { return level_[level + 1]; }
  /// Disks so that those of each box stand side by side.
  const std::vector<std::size_t>& order() const { return order_; }

 private:
  void split(std::size_t box, std::span<const SortedDisk> disks, std::size_t leaf_unknowns);
  void add(std::size_t first, std::size_t last, std::size_t level,
           std::span<const SortedDisk> disks);

  std::vector<Box> boxes_;
  std::vector<std::size_t> level_, order_;
};

}  // namespace flatspeckle::wave

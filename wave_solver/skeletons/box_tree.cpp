#include "wave_solver/skeletons/box_tree.h"

#include <algorithm>
#include <numeric>

namespace flatspeckle::wave {

BoxTree::BoxTree(std::span<const SortedDisk> disks, std::size_t leaf_unknowns)
    : level_{0}, order_(disks.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!disks.empty()) add(0, disks.size(), 0, disks);
  for (std::size_t box = 0; box < boxes_.size();) {
    level_.push_back(boxes_.size());
    for (; box < level_.back(); ++box) split(box, disks, leaf_unknowns);
  }
}

void BoxTree::add(std::size_t first, std::size_t last, std::size_t level,
                  std::span<const SortedDisk> disks) {
  const auto rims = [&](std::size_t place) {
    const SortedDisk& disk = disks[order_[place]];
    const Vec2 reach{disk.radius, disk.radius};
    return Rectangle{disk.centre - reach, disk.centre + reach};
  };
  Rectangle hull = rims(first);
  for (std::size_t place = first + 1; place < last; ++place) hull = hull.joined(rims(place));
  boxes_.push_back({hull, first, last, 0, level});
}

void BoxTree::split(std::size_t box, std::span<const SortedDisk> disks, std::size_t leaf_unknowns) {
  const std::size_t first = boxes_[box].first, last = boxes_[box].last;
  const Vec2 one = disks[order_[first]].centre;
  Rectangle extent{one, one};
  std::size_t unknowns = 0;
  for (std::size_t place = first; place < last; ++place) {
    const SortedDisk& disk = disks[order_[place]];
    extent = extent.joined({disk.centre, disk.centre});
    unknowns += disk.unknowns;
  }
  if (unknowns <= leaf_unknowns) return;

  const bool along_x = extent.width() > extent.depth();
  const Vec2 middle = extent.low + 0.5 * (extent.high - extent.low);
  const auto cut =
      std::stable_partition(order_.begin() + first, order_.begin() + last, [&](std::size_t disk) {
        const Vec2 centre = disks[disk].centre;
        return along_x ? centre.x < middle.x : centre.z < middle.z;
      });
  const auto half = static_cast<std::size_t>(cut - order_.begin());
  if (half == first || half == last) return;  // common centres, or neighbouring numbers
  boxes_[box].child = boxes_.size();
  const std::size_t level = boxes_[box].level + 1;
  add(first, half, level, disks);
  add(half, last, level, disks);
}

}  // namespace flatspeckle::wave

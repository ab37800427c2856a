#include "flatland/placement/event_chain.h"

#include <algorithm>
#include <cmath>

#include "core/contract.h"

namespace flatspeckle {

namespace {

/// What rounding may take from a distance must not make disks touch.
constexpr double rounding_margin = 1e-11;

struct Neighbours {
  std::uint32_t cell;
  double shift;  ///< of the periodic image that is near
};

/// The cell `step` further on (-1, 0 or 1) around the box.
Neighbours neighbour(std::uint32_t cell, int step, std::uint32_t cells, double length) {
  if (step < 0 && cell == 0) return {cells - 1, -length};
  if (step > 0 && cell + 1 == cells) return {0, length};
  return {cell + static_cast<std::uint32_t>(step), 0};
}

}  // namespace

EventChains::EventChains(const Domain& box, std::span<const double> radii)
    : length_{box.width, box.depth}, radius_(radii.begin(), radii.end()), reach_(radii.size()) {
  for (double& radius : radius_) radius *= 1 + rounding_margin;
  const double contact = 2 * *std::max_element(radius_.begin(), radius_.end());
  // Many more cells than disks would only cost memory.
  const double most_cells = 3 + 2 * std::sqrt(static_cast<double>(size()));
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double cells = std::floor(std::min(length_[axis] / contact, most_cells));
    FS_EXPECT(cells >= 3);
    cells_[axis] = static_cast<std::uint32_t>(cells);
    cell_size_[axis] = length_[axis] / cells;
    at_[axis].resize(size());
    cell_[axis].resize(size());
  }
  first_.assign(std::size_t{cells_[0]} * cells_[1], none);
  next_.assign(size(), none);
  previous_.assign(size(), none);
}

Vec2 EventChains::centre(std::size_t disk) const {
  return {at_[0][disk] - length_[0] / 2, at_[1][disk]};
}

void EventChains::enter(std::uint32_t disk) {
  std::uint32_t& first = first_in({cell_[0][disk], cell_[1][disk]});
  previous_[disk] = none;
  next_[disk] = first;
  if (first != none) previous_[first] = disk;
  first = disk;
}

void EventChains::leave(std::uint32_t disk) {
  const std::uint32_t before = previous_[disk], after = next_[disk];
  if (after != none) previous_[after] = before;
  if (before != none)
    next_[before] = after;
  else
    first_in({cell_[0][disk], cell_[1][disk]}) = after;
}

template <typename Visit>
void EventChains::visit_near(const std::array<double, 2>& point, Visit visit) const {
  std::array<std::uint32_t, 2> cell;
  for (std::size_t axis = 0; axis < 2; ++axis)
    cell[axis] =
        std::min(static_cast<std::uint32_t>(point[axis] / cell_size_[axis]), cells_[axis] - 1);
  for (int i = -1; i <= 1; ++i) {
    const Neighbours x = neighbour(cell[0], i, cells_[0], length_[0]);
    for (int j = -1; j <= 1; ++j) {
      const Neighbours z = neighbour(cell[1], j, cells_[1], length_[1]);
      for (std::uint32_t l = first_in({x.cell, z.cell}); l != none; l = next_[l])
        visit(l, Vec2{at_[0][l] + x.shift - point[0], at_[1][l] + z.shift - point[1]});
    }
  }
}

bool EventChains::place(std::size_t disk, Vec2 centre, double scale) {
  const std::array<double, 2> point{centre.x + length_[0] / 2, centre.z};
  const double radius = scale * radius_[disk];
  bool free = true;
  visit_near(point, [&](std::uint32_t other, Vec2 distance) {
    free = free && length(distance) > radius + reach_[other];
  });
  if (!free) return false;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    at_[axis][disk] = point[axis];
    cell_[axis][disk] =
        std::min(static_cast<std::uint32_t>(point[axis] / cell_size_[axis]), cells_[axis] - 1);
  }
  reach_[disk] = radius;
  enter(static_cast<std::uint32_t>(disk));
  return true;
}

bool EventChains::grow(std::size_t disk) {
  double room = radius_[disk];
  visit_near({at_[0][disk], at_[1][disk]}, [&](std::uint32_t other, Vec2 distance) {
    if (other != disk) room = std::min(room, length(distance) - reach_[other]);
  });
  reach_[disk] = std::max(reach_[disk], room);
  return reach_[disk] == radius_[disk];
}

EventChains::Contact EventChains::next_contact(std::size_t axis, std::uint32_t disk,
                                               double farthest) const {
  const std::size_t across = 1 - axis;
  const double along = at_[axis][disk], aside = at_[across][disk], radius = reach_[disk];
  Contact contact{farthest, none, 0};
  std::array<std::uint32_t, 2> cell;
  for (int ahead = 0; ahead <= 1; ++ahead) {
    const Neighbours column = neighbour(cell_[axis][disk], ahead, cells_[axis], length_[axis]);
    cell[axis] = column.cell;
    for (int side = -1; side <= 1; ++side) {
      const Neighbours row = neighbour(cell_[across][disk], side, cells_[across], length_[across]);
      cell[across] = row.cell;
      for (std::uint32_t l = first_in(cell); l != none; l = next_[l]) {
        const double dx = at_[axis][l] + column.shift - along;
        const double dz = at_[across][l] + row.shift - aside;
        const double reach = radius + reach_[l], free = reach * reach - dz * dz;
        if (dx <= 0 || free <= 0) continue;
        const double distance = dx - std::sqrt(free);
        if (distance < contact.distance) contact = {std::max(distance, 0.0), l, dx - distance};
      }
    }
  }
  return contact;
}

double EventChains::move(std::size_t axis, std::size_t first, double length) {
  double travelled = length;
  auto disk = static_cast<std::uint32_t>(first);
  for (;;) {
    std::uint32_t& cell = cell_[axis][disk];
    // Cells are wider than any contact, so up to the end of this one nothing beyond the next is
    // met.
    const double end = (cell + 1) * cell_size_[axis];
    const double to_end = end - at_[axis][disk];
    const Contact contact = next_contact(axis, disk, std::min(to_end, length));
    length -= contact.distance;
    at_[axis][disk] += contact.distance;
    if (contact.disk != none) {
      travelled += contact.jump;
      disk = contact.disk;
    } else if (contact.distance < to_end) {
      return travelled;
    } else {
      leave(disk);
      const bool last = cell + 1 == cells_[axis];
      cell = last ? 0 : cell + 1;
      at_[axis][disk] = last ? 0 : end;
      enter(disk);
    }
  }
}

}  // namespace flatspeckle

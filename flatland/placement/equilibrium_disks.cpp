#include "flatland/placement/equilibrium_disks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/contract.h"
#include "core/error.h"
#include "flatland/media/structure_factor.h"

namespace flatspeckle {

namespace {

/// Relative margin by which radii are enlarged, so that rounding of distances cannot make disks
/// touch.
constexpr double rounding_margin = 1e-11;

/// A neighbouring column or row of cells along one axis of the periodic box.
struct Neighbours {
  std::uint32_t cell;
  double shift;  ///< translation to the periodic image of `cell` that is the neighbour
};

/// Returns the cell at `step` (-1, 0 or 1) from a cell along one axis of the periodic box.
Neighbours neighbour(std::uint32_t cell, int step, std::uint32_t cells, double length) {
  if (step < 0 && cell == 0) return {cells - 1, -length};
  if (step > 0 && cell + 1 == cells) return {0, length};
  return {cell + static_cast<std::uint32_t>(step), 0};
}

/// Returns the packing fraction up to which random sequential addition is fast.
double start_packing(std::size_t axes) {
  return axes == 3 ? 0.2 : 0.3;
}
/// Number of contacts per chain. It is small enough for density waves to relax at their fastest
/// rate.
constexpr double contacts_per_chain = 20;

/// Returns the number of contacts per disk after which the state no longer depends on the initial
/// one. Relaxation times were measured with up to 1000 disks. Below packing 0.65 density waves
/// relax most slowly, in 10 to 20 contacts per disk. Above packing 0.65 the orientation of the
/// bonds between neighbours relaxes most slowly, in 25 contacts per disk at 0.65 and 330 at 0.69.
/// Spheres, whose fluid freezes at 0.494, need fewer.
double contacts_per_disk(double packing, std::size_t axes) {
  return axes == 3 ? 100 : 100 + 0.8 / std::pow(0.71 - packing, 2);
}

/// Returns the mean distance that a chain moves between contacts. At a contact the motion jumps by
/// pi/4 diameters on average, in space by 2/3. The ratio of jumps to distance is Z - 1 = 2 eta
/// g(contact), in space 4 eta g(contact), with Z the compressibility factor, eta the packing
/// fraction and g the pair correlation function. In space Z is that of Carnahan and Starling
/// [carnahan1969]. In a dilute gas the mean spacing is returned if it is shorter.
double free_distance(double packing, double mean_diameter, double spacing, std::size_t axes) {
  const double jumps = axes == 3
                           ? 4 * packing * (1 - packing / 2) / std::pow(1 - packing, 3)
                           : 2 * packing * HardDiskFluid(packing, mean_diameter).contact_value();
  return std::min((axes == 3 ? 2.0 / 3 : std::numbers::pi / 4) * mean_diameter / jumps, spacing);
}

class Fluid {
 public:
  Fluid(const Domain& box, std::span<const double> radii, RandomStream& random)
      : box_(box), random_(random), chains_(box, radii) {
    const std::size_t axes = chains_.axes();
    double content = 0;
    for (double radius : radii)
      content += axes == 3 ? 4 * std::numbers::pi / 3 * (radius * radius * radius)
                           : std::numbers::pi * radius * radius;
    packing_ = content / box.content();
    const double disks = static_cast<double>(radii.size()), each = box.content() / disks;
    const double mean_diameter = 2 * std::accumulate(radii.begin(), radii.end(), 0.0) / disks;
    chain_length_ =
        contacts_per_chain *
        free_distance(packing_, mean_diameter, axes == 3 ? std::cbrt(each) : std::sqrt(each), axes);
  }

  /// Places all disks, with reduced radii if the packing is high, then grows them to full size
  /// while they move.
  void fill() {
    const double filled = start_packing(chains_.axes()) / packing_;
    const double scale = std::min(1.0, chains_.axes() == 3 ? std::cbrt(filled) : std::sqrt(filled));
    for (std::size_t disk = 0; disk < chains_.size(); ++disk)
      try_until([&] { return chains_.place(disk, anywhere(), scale); });
    try_until([&] {
      const bool grown = all_grow();
      if (!grown) move(1);
      return grown;
    });
  }

  void equilibrate() { move(contacts_per_disk(packing_, chains_.axes())); }

  /// Returns all centres, shifted by one common random vector, which makes the density exactly
  /// uniform.
  std::vector<Vec> centres() {
    const Vec shift = anywhere();
    std::vector<Vec> result;
    for (std::size_t disk = 0; disk < chains_.size(); ++disk) {
      Vec moved = chains_.centre(disk) + shift;
      moved.x -= box_.width * std::floor(moved.x / box_.width + 0.5);
      moved.z -= box_.depth * std::floor(moved.z / box_.depth);
      if (box_.height > 0) moved.y -= box_.height * std::floor(moved.y / box_.height + 0.5);
      result.push_back(moved);
    }
    return result;
  }

 private:
  template <typename Attempt>
  void try_until(Attempt attempt) {
    constexpr int most_tries = 100'000;
    for (int tries = 0; !attempt(); ++tries)
      if (tries == most_tries)
        throw InputError(
            "the disks cannot be packed: the large disks leave no space for the small ones; lower "
            "the density or min_gap");
  }

  bool all_grow() {
    bool grown = true;
    for (std::size_t disk = 0; disk < chains_.size(); ++disk) grown = chains_.grow(disk) && grown;
    return grown;
  }

  void move(double contacts_each) {
    const auto disks = static_cast<double>(chains_.size());
    const double number = std::ceil(contacts_each * disks / contacts_per_chain);
    for (double chain = 0; chain < number; ++chain) {
      const auto axes = static_cast<double>(chains_.axes());
      const auto axis =
          std::min(static_cast<std::size_t>(random_.uniform() * axes), chains_.axes() - 1);
      const auto first = static_cast<std::size_t>(random_.uniform() * disks);
      chains_.move(axis, std::min(first, chains_.size() - 1), chain_length_);
    }
  }

  Vec anywhere() {
    const double x = (random_.uniform() - 0.5) * box_.width, z = random_.uniform() * box_.depth;
    return {x, z, box_.height > 0 ? (random_.uniform() - 0.5) * box_.height : 0};
  }

  Domain box_;
  RandomStream& random_;
  EventChains chains_;
  double packing_ = 0, chain_length_ = 0;
};

}  // namespace

EventChains::EventChains(const Domain& box, std::span<const double> radii)
    : axes_(box.height > 0 ? 3 : 2),
      length_{box.width, box.depth, box.height},
      cell_size_{},
      cells_{1, 1, 1},
      radius_(radii.begin(), radii.end()),
      reach_(radii.size()) {
  for (double& radius : radius_) radius *= 1 + rounding_margin;
  const double contact = 2 * *std::max_element(radius_.begin(), radius_.end());
  // A finer grid, with many more cells than disks, would only cost memory.
  const auto number = static_cast<double>(size());
  const double most_cells = 3 + 2 * (axes_ == 3 ? std::cbrt(number) : std::sqrt(number));
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    const double cells = std::floor(std::min(length_[axis] / contact, most_cells));
    FS_EXPECT(cells >= 3);
    cells_[axis] = static_cast<std::uint32_t>(cells);
    cell_size_[axis] = length_[axis] / cells;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at_[axis].assign(size(), 0);
    cell_[axis].assign(size(), 0);
  }
  first_.assign(std::size_t{cells_[0]} * cells_[1] * cells_[2], none);
  next_.assign(size(), none);
  previous_.assign(size(), none);
}

Vec EventChains::centre(std::size_t disk) const {
  return {at_[0][disk] - length_[0] / 2, at_[1][disk], at_[2][disk] - length_[2] / 2};
}

std::array<double, 3> EventChains::point_of(Vec centre) const {
  return {centre.x + length_[0] / 2, centre.z, centre.y + length_[2] / 2};
}

EventChains::Cell EventChains::cell_of(const std::array<double, 3>& point) const {
  Cell cell{};
  for (std::size_t axis = 0; axis < axes_; ++axis)
    cell[axis] =
        std::min(static_cast<std::uint32_t>(point[axis] / cell_size_[axis]), cells_[axis] - 1);
  return cell;
}

void EventChains::enter(std::uint32_t disk) {
  std::uint32_t& first = first_in({cell_[0][disk], cell_[1][disk], cell_[2][disk]});
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
    first_in({cell_[0][disk], cell_[1][disk], cell_[2][disk]}) = after;
}

template <typename Visit>
void EventChains::visit_near(const std::array<double, 3>& point, Visit visit) const {
  const Cell cell = cell_of(point);
  const int levels = axes_ == 3 ? 1 : 0;
  for (int i = -1; i <= 1; ++i) {
    const Neighbours x = neighbour(cell[0], i, cells_[0], length_[0]);
    for (int j = -1; j <= 1; ++j) {
      const Neighbours z = neighbour(cell[1], j, cells_[1], length_[1]);
      for (int level = -levels; level <= levels; ++level) {
        const Neighbours y = neighbour(cell[2], level, cells_[2], length_[2]);
        for (std::uint32_t l = first_in({x.cell, z.cell, y.cell}); l != none; l = next_[l])
          visit(l, Vec{at_[0][l] + x.shift - point[0], at_[1][l] + z.shift - point[1],
                       at_[2][l] + y.shift - point[2]});
      }
    }
  }
}

bool EventChains::place(std::size_t disk, Vec centre, double scale) {
  const auto point = point_of(centre);
  const double radius = scale * radius_[disk];
  bool free = true;
  visit_near(point, [&](std::uint32_t other, Vec distance) {
    free = free && length(distance) > radius + reach_[other];
  });
  if (!free) return false;
  const Cell cell = cell_of(point);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at_[axis][disk] = point[axis];
    cell_[axis][disk] = cell[axis];
  }
  reach_[disk] = radius;
  enter(static_cast<std::uint32_t>(disk));
  return true;
}

bool EventChains::grow(std::size_t disk) {
  double free_radius = radius_[disk];
  visit_near({at_[0][disk], at_[1][disk], at_[2][disk]}, [&](std::uint32_t other, Vec distance) {
    if (other != disk) free_radius = std::min(free_radius, length(distance) - reach_[other]);
  });
  reach_[disk] = std::max(reach_[disk], free_radius);
  return reach_[disk] == radius_[disk];
}

EventChains::Contact EventChains::next_contact(std::size_t axis, std::uint32_t disk,
                                               double farthest) const {
  // In the plane the third axis has one cell, and all its coordinates are 0.
  const std::size_t across = axis == 0 ? 1 : 0, other = axis == 2 ? 1 : 2;
  const int levels = axes_ == 3 ? 1 : 0;
  const double along = at_[axis][disk], radius = reach_[disk];
  Contact contact{farthest, none, 0};
  Cell cell{};
  const auto beside = [&](std::size_t side_axis, int side) {
    const Neighbours row =
        neighbour(cell_[side_axis][disk], side, cells_[side_axis], length_[side_axis]);
    cell[side_axis] = row.cell;
    return row.shift;
  };
  for (int ahead = 0; ahead <= 1; ++ahead) {
    const Neighbours column = neighbour(cell_[axis][disk], ahead, cells_[axis], length_[axis]);
    cell[axis] = column.cell;
    for (int side = -levels; side <= levels; ++side) {
      const double shift_y = beside(other, side);
      for (int row = -1; row <= 1; ++row) {
        const double shift_z = beside(across, row);
        for (std::uint32_t l = first_in(cell); l != none; l = next_[l]) {
          const double dx = at_[axis][l] + column.shift - along;
          const double dz = at_[across][l] + shift_z - at_[across][disk];
          const double dy = at_[other][l] + shift_y - at_[other][disk];
          const double reach = radius + reach_[l], free = reach * reach - dz * dz - dy * dy;
          if (dx <= 0 || free <= 0) continue;
          const double distance = dx - std::sqrt(free);
          if (distance < contact.distance) contact = {std::max(distance, 0.0), l, dx - distance};
        }
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
    // Cells are wider than any contact distance. Up to the end of its cell, the disk can therefore
    // meet only disks of this cell and of the next.
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

std::vector<Vec> draw_equilibrium_disks(const Domain& box, std::span<const double> radii,
                                        RandomStream& random) {
  if (radii.empty()) return {};
  Fluid fluid(box, radii, random);
  fluid.fill();
  fluid.equilibrate();
  return fluid.centres();
}

}  // namespace flatspeckle

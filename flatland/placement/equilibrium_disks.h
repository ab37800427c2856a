#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/random.h"
#include "flatland/media/domain.h"

namespace flatspeckle {

/// Hard disks, in space hard spheres, in a box with periodic edges, moved by straight event chains
/// (Bernard, Krauth and Wilson [bernard2009], Phys. Rev. E 80, 056704): a disk moves until it
/// touches another, which then moves instead, until the whole chain has moved a given length. No
/// move is rejected, and the equilibrium distribution is preserved. Each side of the box must be at
/// least three times the largest contact distance of two disks.
class EventChains {
 public:
  /// Radii include half of the gap between disks. No disk is placed yet. The box is in space if it
  /// has a height.
  EventChains(const Domain& box, std::span<const double> radii);

  std::size_t size() const { return reach_.size(); }
  /// Number of axes: 2 or, in space, 3.
  std::size_t axes() const { return axes_; }
  /// Returns the centre of a placed disk, in the box |x| <= width/2, 0 <= z <= depth, |y| <=
  /// height/2.
  Vec centre(std::size_t disk) const;
  double reach(std::size_t disk) const { return reach_[disk]; }

  /// Places a disk that is not placed yet, with `scale` times its radius. Returns false and changes
  /// nothing if it would overlap another disk.
  bool place(std::size_t disk, Vec centre, double scale = 1);
  /// Grows a placed disk up to its radius, as far as its neighbours allow. Returns whether the disk
  /// has its full radius.
  bool grow(std::size_t disk);

  /// Moves one chain along x (axis 0), z (1) or y (2), beginning with `disk`. At each contact the
  /// motion jumps to the next disk, over the distance between the two centres along the axis.
  /// Returns `length` plus the sum of these jumps. For equal disks the mean of the returned value,
  /// divided by `length`, is the compressibility factor Z (Michel, Kapfer and Krauth [michel2014],
  /// J. Chem. Phys. 140, 054116).
  double move(std::size_t axis, std::size_t disk, double length);

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  using Cell = std::array<std::uint32_t, 3>;
  struct Contact {
    double distance;
    std::uint32_t disk;  ///< `none` if no disk is in the way
    double jump;         ///< distance between both centres along the axis
  };

  std::size_t number_of(const Cell& cell) const {
    return (std::size_t{cell[0]} * cells_[1] + cell[1]) * cells_[2] + cell[2];
  }
  std::uint32_t& first_in(const Cell& cell) { return first_[number_of(cell)]; }
  std::uint32_t first_in(const Cell& cell) const { return first_[number_of(cell)]; }
  Cell cell_of(const std::array<double, 3>& point) const;
  std::array<double, 3> point_of(Vec centre) const;
  void enter(std::uint32_t disk);
  void leave(std::uint32_t disk);
  /// Calls visit(disk, vector from the point) for the disks of the 3 x 3 cells around a point, in
  /// space of 3 x 3 x 3.
  template <typename Visit>
  void visit_near(const std::array<double, 3>& point, Visit visit) const;
  Contact next_contact(std::size_t axis, std::uint32_t disk, double farthest) const;

  std::size_t axes_;
  std::array<double, 3> length_, cell_size_;
  Cell cells_;
  std::array<std::vector<double>, 3> at_;  ///< centres, [axis][disk], in [0, length)
  std::vector<double> radius_, reach_;     ///< full radius; current radius
  std::array<std::vector<std::uint32_t>, 3> cell_;
  std::vector<std::uint32_t> first_, next_, previous_;  ///< linked list of the disks of each cell
};

/// Draws the centres of hard disks, or spheres in space, from the equilibrium fluid in a box with
/// periodic edges. The box
/// is a window on a homogeneous fluid without walls, whose density is uniform. Disks that do not
/// overlap in the periodic box do not overlap in the plane either, where distances are no shorter.
/// Radii include half of the gap between disks. They may differ, in descending order. The result
/// depends only on the arguments. Preconditions: the packing fraction is at most 0.69, of spheres
/// 0.49 (the fluid freezes above), and each side of the box is at least three times the largest
/// diameter.
/// Throws InputError if disks of very different size cannot be placed.
std::vector<Vec> draw_equilibrium_disks(const Domain& box, std::span<const double> radii,
                                        RandomStream& random);

}  // namespace flatspeckle

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/random.h"
#include "flatland/media/domain.h"

namespace flatspeckle {

/// Hard disks in a box with periodic edges, moved by straight event chains (Bernard, Krauth and
/// Wilson 2009, Phys. Rev. E 80, 056704): a disk moves until it meets another, which moves on in
/// its place, until the whole chain has moved a stated length. No move is refused, and the
/// equilibrium fluid is left unchanged. The box must be at least three of the largest distances of
/// contact wide and deep.
class EventChains {
 public:
  /// Radii include half of the gap that disks are to keep. No disk has a place yet.
  EventChains(const Domain& box, std::span<const double> radii);

  std::size_t size() const { return reach_.size(); }
  /// Of a disk that has a place; in the box |x| <= width/2, 0 <= z <= depth.
  Vec2 centre(std::size_t disk) const;
  double reach(std::size_t disk) const { return reach_[disk]; }

  /// Gives a disk without a place one, at scale times its radius. False, and nothing is changed,
  /// where it would overlap.
  bool place(std::size_t disk, Vec2 centre, double scale = 1);
  /// Lets a placed disk grow up to its radius, as far as its neighbours allow. True if it has that
  /// radius.
  bool grow(std::size_t disk);

  /// Moves one chain along x (axis 0) or z (axis 1), `disk` first. Returns length plus the
  /// distances between centres, along the chain, over which the motion jumped: for equal disks its
  /// mean over the length is the compressibility factor Z (Michel, Kapfer and Krauth 2014, J. Chem.
  /// Phys. 140, 054116).
  double move(std::size_t axis, std::size_t disk, double length);

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  struct Contact {
    double distance;
    std::uint32_t disk;  ///< none: nothing in the way
    double jump;         ///< between centres, along the chain
  };

  std::uint32_t& first_in(const std::array<std::uint32_t, 2>& cell) {
    return first_[cell[0] * cells_[1] + cell[1]];
  }
  std::uint32_t first_in(const std::array<std::uint32_t, 2>& cell) const {
    return first_[cell[0] * cells_[1] + cell[1]];
  }
  void enter(std::uint32_t disk);
  void leave(std::uint32_t disk);
  /// Visits the disks of the 3 x 3 cells around a point, with the vector from it to them.
  template <typename Visit>
  void visit_near(const std::array<double, 2>& point, Visit visit) const;
  Contact next_contact(std::size_t axis, std::uint32_t disk, double farthest) const;

  std::array<double, 2> length_, cell_size_;
  std::array<std::uint32_t, 2> cells_;
  std::array<std::vector<double>, 2> at_;  ///< [axis][disk], in [0, length)
  std::vector<double> radius_, reach_;     ///< full radius; radius now
  std::array<std::vector<std::uint32_t>, 2> cell_;
  std::vector<std::uint32_t> first_, next_, previous_;  ///< disks of a cell as a list
};

/// Centres of hard disks from the equilibrium fluid in a box with periodic edges: the box is a
/// window on a homogeneous fluid without walls, of uniform density. (Distances in the plane are no
/// shorter than periodic ones, so nothing overlaps there either.)
/// Radii include half of the gap that disks are to keep; they may differ, the largest first. A pure
/// function of the random numbers. Preconditions: packing fraction up to 0.69 (above, the fluid
/// freezes), a box at least three of the largest diameters wide and deep. Throws InputError where
/// disks of very different size find no place.
std::vector<Vec2> draw_equilibrium_disks(const Domain& box, std::span<const double> radii,
                                         RandomStream& random);

}  // namespace flatspeckle

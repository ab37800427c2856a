#include "flatland/placement/equilibrium_disks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "flatland/media/structure_factor.h"
#include "flatland/placement/event_chain.h"

namespace flatspeckle {

namespace {

/// Random sequential addition is quick up to here.
constexpr double start_packing = 0.3;
/// Short enough for density waves to relax as fast as they can.
constexpr double contacts_per_chain = 20;

/// Contacts per disk that forget the start. The slowest relaxation measured (N up to 1000) is that
/// of density waves below packing 0.65, 10 to 20 contacts per disk, and beyond it that of the
/// orientation of the bonds, 25 at 0.65 and 330 at 0.69.
double contacts_per_disk(double packing) {
  return 100 + 0.8 / std::pow(0.71 - packing, 2);
}

/// Mean distance between contacts along a chain: each makes the motion jump by pi/4 diameters, and
/// these jumps over the distance are Z - 1 = 2 eta g(contact). In a thin gas there is no need to
/// move further than to the next disk.
double free_distance(double packing, double mean_diameter, double spacing) {
  const double jumps = 2 * packing * HardDiskFluid(packing, mean_diameter).contact_value();
  return std::min(std::numbers::pi / 4 * mean_diameter / jumps, spacing);
}

class Fluid {
 public:
  Fluid(const Domain& box, std::span<const double> radii, RandomStream& random)
      : box_(box), random_(random), chains_(box, radii) {
    double area = 0;
    for (double radius : radii) area += std::numbers::pi * radius * radius;
    packing_ = area / box.area();
    const double disks = static_cast<double>(radii.size());
    const double mean_diameter = 2 * std::accumulate(radii.begin(), radii.end(), 0.0) / disks;
    chain_length_ =
        contacts_per_chain * free_distance(packing_, mean_diameter, std::sqrt(box.area() / disks));
  }

  /// Places all disks, shrunk where they would not fit, then lets them grow while they move.
  void fill() {
    const double scale = std::min(1.0, std::sqrt(start_packing / packing_));
    for (std::size_t disk = 0; disk < chains_.size(); ++disk)
      try_until([&] { return chains_.place(disk, anywhere(), scale); });
    try_until([&] {
      const bool grown = all_grow();
      if (!grown) move(1);
      return grown;
    });
  }

  void equilibrate() { move(contacts_per_disk(packing_)); }

  /// All moved alike by a random vector, which makes the density exactly uniform.
  std::vector<Vec2> centres() {
    const Vec2 shift = anywhere();
    std::vector<Vec2> result;
    for (std::size_t disk = 0; disk < chains_.size(); ++disk) {
      Vec2 moved = chains_.centre(disk) + shift;
      moved.x -= box_.width * std::floor(moved.x / box_.width + 0.5);
      moved.z -= box_.depth * std::floor(moved.z / box_.depth);
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
            "the disks cannot be packed: the large ones leave no room; lower the "
            "density or min_gap");
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
      const std::size_t axis = random_.uniform() < 0.5 ? 0 : 1;
      const auto first = static_cast<std::size_t>(random_.uniform() * disks);
      chains_.move(axis, std::min(first, chains_.size() - 1), chain_length_);
    }
  }

  Vec2 anywhere() {
    const double x = (random_.uniform() - 0.5) * box_.width;
    return {x, random_.uniform() * box_.depth};
  }

  Domain box_;
  RandomStream& random_;
  EventChains chains_;
  double packing_ = 0, chain_length_ = 0;
};

}  // namespace

std::vector<Vec2> draw_equilibrium_disks(const Domain& box, std::span<const double> radii,
                                         RandomStream& random) {
  if (radii.empty()) return {};
  Fluid fluid(box, radii, random);
  fluid.fill();
  fluid.equilibrate();
  return fluid.centres();
}

}  // namespace flatspeckle

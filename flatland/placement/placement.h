#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numbers/random.h"
#include "flatland/media/domain.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle {

struct PlacedScatterer {
  Vec position;
  Scatterer scatterer;
};

/// One realization of a scene: scatterers and their positions.
using Placement = std::vector<PlacedScatterer>;

/// Rule by which realizations are drawn (C12). Points are placed by poisson, disks and spheres by
/// hard_disk or equilibrium. hard_disk is random sequential addition, which places one
/// disk or sphere after the other where it fits. equilibrium draws the fluid of hard disks
/// (draw_equilibrium_disks), which can be packed more densely.
struct PlacementRule {
  enum class Kind { poisson, hard_disk, equilibrium };
  Kind kind = Kind::poisson;
  double mean_count = 0;               ///< density x area
  std::optional<std::uint64_t> count;  ///< fixed number of points; nullopt: Poisson-distributed
  double min_gap = 0;                  ///< least distance between the rims of two disks
};

/// Accepted values of the key `placement`, in the order of PlacementRule::Kind.
inline const std::vector<std::string> placement_words = {"poisson", "hard_disk", "equilibrium"};
inline const std::string& placement_word(PlacementRule::Kind kind) {
  return placement_words[static_cast<std::size_t>(kind)];
}

/// Returns the kind of placement that `word` names or, if it is not given, hard_disk for disks and
/// poisson for points. Throws InputError if the kind named does not suit these scatterers.
PlacementRule::Kind placement_kind(const std::optional<std::string>& word, bool disks);

/// Largest number of scatterers accepted; no machine could solve more.
inline constexpr double most_scatterers = 1e7;

/// Throws InputError if the rule places more than most_scatterers.
void require_placeable(const PlacementRule& rule);

/// Draws a realization in a box. Centres are uniform in the box; disks may extend past its edge.
/// The number of disks is rounded to the nearest integer.
Placement draw_placement(const Domain& box, const Scatterer& scatterer, const PlacementRule& rule,
                         RandomStream& random);

/// Draws the centres of disks, in space of spheres, with the given radii by hard_disk or
/// equilibrium; the largest are placed first. Throws InputError under the conditions of
/// check_packing().
std::vector<Vec> draw_disks(const Domain& box, std::span<const double> radii,
                            PlacementRule::Kind kind, double min_gap, RandomStream& random);

/// Throws InputError if the packing fraction is too high for the rule. Random sequential addition
/// jams at 0.547 and becomes far too slow well below; the equilibrium fluid freezes at 0.70. For
/// equilibrium, also throws if the largest diameter is too large for the box. Spheres have the
/// limits 0.33 and 0.49. packing and largest: packing fraction and largest diameter of the disks,
/// with half the gap included in their radii.
void check_packing(const Domain& box, PlacementRule::Kind kind, double packing, double largest);

/// Default of the least gap between disks, in radii. Without it some of many random disks would
/// nearly touch, which the exact solver does not accept.
inline constexpr double default_gap = 1e-3;

/// Reads a CSV file with columns x, z, in space also y (0 if it is missing), [, radius [, index_re,
/// index_im]], named in its first line.
/// Values that have no column come from `scatterer`. Throws InputError if anything is missing,
/// malformed or not finite, and if two scatterers overlap.
Placement read_placement(const std::string& path, const Scatterer& scatterer,
                         bool in_space = false);

/// Throws InputError if a near sensor lies inside a disk or on a point.
void require_outside(const Placement& placement, Vec sensor);

/// Returns the smallest gap between the rims of two disks, or `within` if all gaps are larger.
double smallest_gap(const Placement& placement, double within);

/// Throws InputError naming two scatterers that overlap or coincide.
void check_no_overlap(const Placement& placement);

}  // namespace flatspeckle

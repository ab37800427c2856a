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
  Vec2 position;
  Scatterer scatterer;
};

/// One realization: scatterers at stated positions.
using Placement = std::vector<PlacedScatterer>;

/// How realizations are drawn (C12). Poisson: points only. Disks: hard_disk is random sequential
/// addition, one disk after the other where there is room; equilibrium is the fluid of hard disks
/// (draw_equilibrium_disks), which can be packed closer.
struct PlacementRule {
  enum class Kind { poisson, hard_disk, equilibrium };
  Kind kind = Kind::poisson;
  double mean_count = 0;               ///< density x area
  std::optional<std::uint64_t> count;  ///< fixes the number of a Poisson placement
  double min_gap = 0;                  ///< between the rims of disks
};

/// As in scene files, by kind.
inline const std::vector<std::string> placement_words = {"poisson", "hard_disk", "equilibrium"};
inline const std::string& placement_word(PlacementRule::Kind kind) {
  return placement_words[static_cast<std::size_t>(kind)];
}

/// The kind that a word names, by default that of disks, or of points. Throws InputError for one
/// that is not of them.
PlacementRule::Kind placement_kind(const std::optional<std::string>& word, bool disks);

/// More is refused: no machine solves it.
inline constexpr double most_scatterers = 1e7;

/// Throws InputError for more than most_scatterers.
void require_placeable(const PlacementRule& rule);

/// Draws a realization in a box. Centres are uniform in the box; disks may reach past its edge, and
/// their number is rounded to the nearest whole one.
Placement draw_placement(const Domain& box, const Scatterer& scatterer, const PlacementRule& rule,
                         RandomStream& random);

/// Centres of disks of these radii, by a rule for disks; the largest are placed first. Throws
/// InputError where check_packing does.
std::vector<Vec2> draw_disks(const Domain& box, std::span<const double> radii,
                             PlacementRule::Kind kind, double min_gap, RandomStream& random);

/// Throws InputError where disks are too many for the rule (random sequential addition jams at
/// 0.547 and is hopelessly slow well before; the equilibrium fluid freezes at 0.70) or, for
/// equilibrium, the largest diameter is too large for the box. Both count half the gap as part of
/// the radii.
void check_packing(const Domain& box, PlacementRule::Kind kind, double packing, double largest);

/// Least gap, in radii, between disks whose gap is not stated: the exact solver takes no disks that
/// nearly touch, and some of many drawn at random would.
inline constexpr double default_gap = 1e-3;

/// Reads columns x, z [, radius [, index_re, index_im]] by the names in the first line; what a
/// column does not give comes from `scatterer`. Throws InputError on anything missing, malformed,
/// or not finite, and where two scatterers overlap.
Placement read_placement(const std::string& path, const Scatterer& scatterer);

/// Throws InputError where a near sensor lies inside a disk or on a point.
void require_outside(const Placement& placement, Vec2 sensor);

/// The least distance between rims, among disks closer than `within`; that where none is closer.
double smallest_gap(const Placement& placement, double within);

/// Throws InputError naming two scatterers that overlap or coincide.
void check_no_overlap(const Placement& placement);

}  // namespace flatspeckle

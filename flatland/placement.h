#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/random.h"
#include "flatland/domain.h"
#include "flatland/scatterer.h"

namespace flatspeckle {

struct PlacedScatterer {
  Vec2 position;
  Scatterer scatterer;
};

/// One realization: scatterers at stated positions.
using Placement = std::vector<PlacedScatterer>;

/// How realizations are drawn (C12).
struct PlacementRule {
  enum class Kind { poisson, hard_disk };
  Kind kind = Kind::poisson;
  double mean_count = 0;               ///< density x area
  std::optional<std::uint64_t> count;  ///< fixes the number of a Poisson placement
  double min_gap = 0;                  ///< between the rims of hard disks
};

/// Draws a realization in a box. Centres are uniform in the box; disks may reach past its edge.
/// Hard disks: random sequential addition, the number rounded to the nearest whole one.
Placement draw_placement(const Domain& box, const Scatterer& scatterer, const PlacementRule& rule,
                         RandomStream& random);

/// Packing fraction, counted with half the gap added to the radii, above which hard disks are
/// refused: random sequential addition jams at 0.547 and is hopelessly slow well before.
inline constexpr double highest_sequential_packing = 0.5;

/// Reads columns x, z [, radius [, index_re, index_im]] by the names in the first line; what a
/// column does not give comes from `scatterer`. Throws InputError on anything missing, malformed,
/// or not finite, and where two scatterers overlap.
Placement read_placement(const std::string& path, const Scatterer& scatterer);

/// Throws InputError naming two scatterers that overlap or coincide.
void check_no_overlap(const Placement& placement);

}  // namespace flatspeckle

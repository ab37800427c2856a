#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "flatland/media/layers.h"
#include "flatland/placement/cell_grid.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

namespace {

Vec uniform_between(const Domain& box, double from, double to, RandomStream& random) {
  const double x = (random.uniform() - 0.5) * box.width;
  return {x, from + random.uniform() * (to - from)};
}

/// Draws points in a medium that varies, by thinning. Points are drawn with a uniform density that
/// the medium nowhere exceeds. Each point is kept with the probability (local density) / (uniform
/// density).
Placement thinned(const Scene& scene, RandomStream& random) {
  const MediumProfile& profile = *scene.profile;
  PlacementRule dense = scene.placement;
  dense.mean_count = profile.most_density() * scene.domain.content();
  Placement placement = draw_placement(scene.domain, scene.scatterer, dense, random);
  std::erase_if(placement, [&](PlacedScatterer& placed) {
    placed.scatterer = profile.materials()[profile.material_at(placed.position)].scatterer;
    return random.uniform() * profile.most_density() >= profile.density(placed.position);
  });
  return placement;
}

/// Disks of one material and the depths between which they lie.
struct Population {
  Scatterer scatterer;
  double from, to;
  std::size_t count;
};

/// Returns the populations of a scene, with integer numbers of disks. The largest disks come first,
/// because they would not fit among many small ones.
std::vector<Population> populations(const Scene& scene) {
  const auto whole = [](double mean) { return static_cast<std::size_t>(std::llround(mean)); };
  const auto* layers = dynamic_cast<const Layers*>(scene.profile.get());
  if (layers == nullptr)
    return {{scene.profile->materials().front().scatterer, 0, scene.domain.depth,
             whole(scene.placement.mean_count)}};
  std::vector<Population> list;
  for (std::size_t layer = 0; layer < layers->materials().size(); ++layer) {
    const Material& material = layers->materials()[layer];
    const double area = scene.domain.width * layers->thickness(layer);
    list.push_back({material.scatterer, layers->faces()[layer], layers->faces()[layer + 1],
                    whole(material.medium.density * area)});
  }
  std::ranges::stable_sort(list, std::greater(),
                           [](const Population& some) { return some.scatterer.radius; });
  return list;
}

/// Random sequential addition of disks in a medium that varies. The density of the centres is
/// proportional to the local density of the medium.
class AddedDisks {
 public:
  AddedDisks(const Scene& scene, RandomStream& random)
      : scene_(scene),
        random_(random),
        gap_(std::max(scene.placement.min_gap, default_gap * scene.scatterer.radius)),
        grid_(2 * scene.scatterer.radius + gap_) {}

  Placement placed() {
    for (const Population& population : populations(scene_)) add(population);
    return std::move(placement_);
  }

 private:
  void add(const Population& population) {
    constexpr std::uint64_t most_tries = 100'000'000;
    std::uint64_t tries = 0;
    for (std::size_t placed = 0; placed < population.count;) {
      if (++tries == most_tries)
        throw InputError(
            "the disks cannot be packed by random sequential addition; lower the density");
      const Vec x = uniform_between(scene_.domain, population.from, population.to, random_);
      if (!wanted(x) || taken(x, population.scatterer.radius)) continue;
      grid_.insert(x, placement_.size());
      placement_.push_back({x, population.scatterer});
      ++placed;
    }
  }
  /// Draws whether to keep x as the centre of a disk. In a density map the probability is
  /// proportional to the density. In layers it is 1, because each layer has its own number of
  /// disks.
  bool wanted(Vec x) {
    const MediumProfile& profile = *scene_.profile;
    return profile.materials().size() > 1 ||
           random_.uniform() * profile.most_density() < profile.density(x);
  }
  bool taken(Vec x, double radius) const {
    return grid_.any_near(x, [&](Vec other, std::size_t number) {
      return length(x - other) < radius + placement_[number].scatterer.radius + gap_;
    });
  }

  const Scene& scene_;
  RandomStream& random_;
  double gap_;
  CellGrid grid_;
  Placement placement_;
};

}  // namespace

Placement draw_placement(const Scene& scene, RandomStream& random) {
  if (!scene.profile) return draw_placement(scene.domain, scene.scatterer, scene.placement, random);
  if (!scene.scatterer.is_disk()) return thinned(scene, random);
  if (scene.placement.kind == PlacementRule::Kind::equilibrium)
    throw InputError("placement", "equilibrium", "requires a uniform medium; use hard_disk");
  return AddedDisks(scene, random).placed();
}

}  // namespace flatspeckle

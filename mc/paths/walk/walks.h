#pragma once

#include <cstdint>
#include <memory>

#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/end_factors.h"
#include "mc/paths/walk/path_scorer.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Numbered batches of plan.paths_per_batch walks, each handed to a scorer, and scattering at the
/// ends of paths, which is called once for many ends: its form (scattering.h) is chosen at run
/// time.
class PathWalks {
 public:
  PathWalks(const Scene& scene, const Plan& plan, std::uint64_t seed)
      : scene_(scene), plan_(plan), seed_(seed) {}
  PathWalks(const PathWalks&) = delete;
  virtual ~PathWalks() = default;

  const Scene& scene() const { return scene_; }
  const Plan& plan() const { return plan_; }
  virtual void batch(std::uint64_t number, PathScorer& scorer) const = 0;

  /// A of C14 over sqrt(sigma_s) at x, in the plane of incidence.
  virtual Complex amplitude(Vec2 x, Vec2 from, Vec2 to) const = 0;
  /// Multiplies out[j] by the amplitude towards each of many.
  virtual void towards(Vec2 x, const SpaceDirection& from, const Directions& to,
                       std::span<Complex> out) const = 0;
  /// Factors of ends for the rays of the same medium.
  virtual std::unique_ptr<EndFactors> factors(const Scene& scene, const std::vector<End>& ends,
                                              bool phases) const = 0;

 protected:
  const Scene scene_;
  const Plan plan_;
  const std::uint64_t seed_;
};

/// Null where nothing scatters. Throws InputError where walks cannot be used.
std::shared_ptr<const PathWalks> path_walks(const Scene& scene, const Plan& plan,
                                            std::uint64_t seed);

}  // namespace flatspeckle::mc

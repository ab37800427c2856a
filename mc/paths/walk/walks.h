#pragma once

#include <cstdint>
#include <memory>

#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/end_scattering.h"
#include "mc/paths/walk/path_scorer.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Numbered batches of plan.paths_per_batch walks, each handed to a scorer.
class PathWalks {
 public:
  PathWalks(const Scene& scene, const Plan& plan, std::uint64_t seed)
      : scene_(scene), plan_(plan), seed_(seed) {}
  PathWalks(const PathWalks&) = delete;
  virtual ~PathWalks() = default;

  const Scene& scene() const { return scene_; }
  const Plan& plan() const { return plan_; }
  virtual const EndScattering& scattering() const = 0;
  virtual void batch(std::uint64_t number, PathScorer& scorer) const = 0;

 protected:
  const Scene scene_;
  const Plan plan_;
  const std::uint64_t seed_;
};

/// Null where nothing scatters. Throws InputError where walks cannot be used.
std::shared_ptr<const PathWalks> path_walks(const Scene& scene, const Plan& plan,
                                            std::uint64_t seed);

}  // namespace flatspeckle::mc

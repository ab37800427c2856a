#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/endpoint_factors.h"
#include "mc/paths/walk/path_scorer.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Samples light paths by random walks, in numbered batches of plan.paths_per_batch walks, and
/// passes the paths to a scorer. Also evaluates the scattering towards the endpoints of paths
/// (lights and views). The form of scattering (scattering.h) is selected by virtual calls; they
/// cost little, because one call evaluates many endpoints.
class PathWalks {
 public:
  PathWalks(const Scene& scene, const Plan& plan, std::uint64_t seed)
      : scene_(scene),
        plan_(plan),
        seed_(seed),
        lights_(light_endpoints(scene)),
        views_(view_endpoints(scene)) {}
  PathWalks(const PathWalks&) = delete;
  virtual ~PathWalks() = default;

  const Scene& scene() const { return scene_; }
  const Plan& plan() const { return plan_; }
  /// Endpoints of the lights and views of scene().
  const std::vector<Endpoint>& lights() const { return lights_; }
  const std::vector<Endpoint>& views() const { return views_; }
  virtual void batch(std::uint64_t number, PathScorer& scorer) const = 0;

  /// Returns the scattering amplitude A (conventions, C14) of a scatterer at x divided by
  /// sqrt(sigma_s), for two directions in the plane of incidence.
  virtual Complex amplitude(Vec x, Vec from, Vec to) const = 0;
  /// Multiplies out[j], for all j, by the same amplitude for scattering from `from` to to[j].
  virtual void towards(Vec x, Vec from, const Directions& to, std::span<Complex> out) const = 0;
  /// Makes the endpoint factors (C13) of lights or views. scene: has the medium of these walks, but
  /// may have another wavenumber. phases: whether the factors are complex, not only magnitudes.
  virtual std::unique_ptr<EndpointFactors> factors(const Scene& scene,
                                                   const std::vector<Endpoint>& endpoints,
                                                   bool phases) const = 0;

 protected:
  const Scene scene_;
  const Plan plan_;
  const std::uint64_t seed_;
  const std::vector<Endpoint> lights_, views_;
};

/// Makes the walks of a scene; returns null if nothing scatters. Throws InputError as
/// require_walks() does.
std::shared_ptr<const PathWalks> path_walks(const Scene& scene, const Plan& plan,
                                            std::uint64_t seed);

}  // namespace flatspeckle::mc

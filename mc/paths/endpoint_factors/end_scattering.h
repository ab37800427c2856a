#pragma once

#include <memory>
#include <span>
#include <vector>

#include "mc/paths/endpoint_factors/end_factors.h"
#include "mc/paths/endpoint_factors/space_direction.h"

namespace flatspeckle::mc {

/// Scattering at the ends of paths, in whatever form a scene has it (scattering.h): called once for
/// many ends, so that its form is chosen at run time.
class EndScattering {
 public:
  virtual ~EndScattering() = default;

  /// A of C14 over sqrt(sigma_s) at x, in the plane of incidence.
  virtual Complex amplitude(Vec2 x, Vec2 from, Vec2 to) const = 0;
  /// Multiplies out[j] by the amplitude towards each of many.
  virtual void towards(Vec2 x, const SpaceDirection& from, const Directions& to,
                       std::span<Complex> out) const = 0;
  /// Factors of ends for the rays of the same medium.
  virtual std::unique_ptr<EndFactors> factors(const Scene& scene, const std::vector<End>& ends,
                                              bool phases) const = 0;
};

}  // namespace flatspeckle::mc

#pragma once

#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "grin/design/system/ray_system.h"

namespace flatspeckle::grin::design {

inline double mean(std::span<const double> a) {
  return std::accumulate(a.begin(), a.end(), 0.0) / static_cast<double>(a.size());
}

/// Maps the measurements of all rays to residuals. The search minimises the sum of squared
/// residuals. times() multiplies by the Jacobian of the residuals, transposed() by its transpose;
/// both use the measurements last given to residuals().
class DesignObjective {
 public:
  virtual ~DesignObjective() = default;

  virtual std::vector<double> residuals(std::span<const double> measurements) = 0;
  virtual std::vector<double> times(std::span<const double> measurements) const = 0;
  virtual std::vector<double> transposed(std::span<const double> residuals) const = 0;
  /// Whether the Jacobian is the identity, because residuals are measurements minus their targets.
  virtual bool is_plain() const { return false; }
  /// Returns the approximate weight of each measurement in the residuals.
  virtual std::vector<double> weights() const = 0;
};

/// Makes an objective whose residuals are measurements minus these targets.
std::unique_ptr<DesignObjective> make_target_objective(std::vector<double> targets);

/// Rays, and the objective that maps their measurements to residuals.
struct DesignTask {
  std::unique_ptr<RaySystem> rays;
  std::unique_ptr<DesignObjective> objective;
};

/// Design target: a requirement on the light behind the field. Makes the rays and their objective.
class DesignTarget {
 public:
  virtual ~DesignTarget() = default;
  /// Returns the rays of the search and their objective or, if held_out, the validation rays, which
  /// the search does not use, and their objective.
  virtual DesignTask task(const RayWalk& walk, bool held_out) const = 0;
  virtual double rays() const = 0;  ///< number of rays that the search uses
  /// Returns how many numbers are measured per ray: 1 or 2.
  virtual int measurements() const { return 2; }
};

}  // namespace flatspeckle::grin::design

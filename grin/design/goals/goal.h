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

/// What is asked of the readings of all rays: residuals whose squares are to be as small as can be,
/// and their derivative by the readings where they were looked at last.
class Goal {
 public:
  virtual ~Goal() = default;

  virtual std::vector<double> residuals(std::span<const double> readings) = 0;
  virtual std::vector<double> times(std::span<const double> readings) const = 0;
  virtual std::vector<double> transposed(std::span<const double> residuals) const = 0;
  /// Whether these do nothing: residuals are readings less what they should be.
  virtual bool is_plain() const { return false; }
  /// By how much a reading counts, roughly.
  virtual std::vector<double> weights() const = 0;
};

/// Readings are to be what they are told to be.
std::unique_ptr<Goal> make_target_goal(std::vector<double> targets);

/// Rays, and what is asked of them.
struct DesignTask {
  std::unique_ptr<RaySystem> rays;
  std::unique_ptr<Goal> goal;
};

/// What light is to do.
class Aim {
 public:
  virtual ~Aim() = default;
  /// held_out: of rays that the search does not see.
  virtual DesignTask task(const RayWalk& walk, bool held_out) const = 0;
  virtual double rays() const = 0;  ///< that the search sees
  /// Two numbers are read off each ray, or one.
  virtual int readings() const { return 2; }
};

}  // namespace flatspeckle::grin::design

#pragma once

#include <cmath>
#include <limits>

#include "grin/media/scattering/free_flight.h"
#include "grin/media/scattering/scattering_medium.h"

namespace flatspeckle::grin {

/// A medium as flights and joins see it.
class PartMedium {
 public:
  PartMedium() = default;
  /// The mean of the relative density in the part.
  PartMedium(const ScatteringMedium& medium, double mean_density)
      : grid_(medium.density),
        mu_t_(medium.mu_t()),
        largest_(grid_ ? grid_->largest() : 1),
        reference_(medium.mu_s > 0 ? mu_t_ * mean_density : 0),
        scatters_(medium.mu_s > 0) {}

  bool scatters() const { return scatters_; }
  bool is_uniform() const { return scatters_ && !grid_; }
  double reference() const { return reference_; }
  double mu_t() const { return mu_t_; }
  /// Known to be met everywhere; a grid may be empty.
  double least_extinction() const { return grid_ ? 0 : mu_t_; }
  double majorant() const { return mu_t_ * largest_; }
  const DensityGrid* grid() const { return grid_.get(); }

  /// Is a tentative collision, of density majorant(), one of the true density?
  bool accepts(const Vec3& x, RandomStream& random) const {
    return !grid_ || random.uniform() * largest_ < (*grid_)(x);
  }

  /// What a tentative collision is: one; or none, where light that is not scattered loses weight.
  bool collides(const Vec3& x, double& weight, RandomStream& random) const {
    if (scatters_) return accepts(x, random);
    weight *= lacking(x);
    return false;
  }

  /// The share of tentative collisions that is none.
  double lacking(const Vec3& x) const { return 1 - (*grid_)(x) / largest_; }

  /// The arc length to the next collision along a path x(s), from Woodcock's tentative collisions;
  /// infinity if it would be beyond `longest`.
  template <class Path>
  double free_path(const Path& x, double longest, RandomStream& random) const {
    if (!scatters_) return std::numeric_limits<double>::infinity();
    double s = sample_free_flight(majorant(), random.uniform());
    while (s < longest && !accepts(x(s), random))
      s += sample_free_flight(majorant(), random.uniform());
    return s < longest ? s : std::numeric_limits<double>::infinity();
  }

  /// exp(-integral of mu_t) along the path; in a grid an unbiased estimate by ratio tracking.
  template <class Path>
  double transmitted(const Path& x, double length, RandomStream& random) const {
    if (!(mu_t_ > 0)) return 1;
    return grid_ ? ratio_tracked(x, length, random) : transmittance(mu_t_, length);
  }

 private:
  template <class Path>
  double ratio_tracked(const Path& x, double length, RandomStream& random) const {
    double left = 1;
    for (double s = sample_free_flight(majorant(), random.uniform()); s < length && left > 0;
         s += sample_free_flight(majorant(), random.uniform()))
      left *= lacking(x(s));
    return left;
  }

  std::shared_ptr<const DensityGrid> grid_;
  double mu_t_ = 0, largest_ = 1, reference_ = 0;
  bool scatters_ = false;
};

}  // namespace flatspeckle::grin

#pragma once

#include <cmath>
#include <limits>

#include "grin/media/scattering/free_flight.h"
#include "grin/media/scattering/labelled_media.h"
#include "grin/media/scattering/scattering_medium.h"

namespace flatspeckle::grin {

/// The medium of a part of the stage, for flights and connections.
class PartMedium {
 public:
  PartMedium() = default;
  /// mean_density: mean of the relative density in the part.
  PartMedium(const ScatteringMedium& medium, double mean_density)
      : grid_(medium.density),
        labels_(medium.labels),
        mu_t_(medium.mu_t()),
        largest_(medium.largest_relative()),
        reference_(medium.mu_s > 0 ? mu_t_ * mean_density : 0),
        scatters_(medium.mu_s > 0) {}

  bool scatters() const { return scatters_; }
  bool is_uniform() const { return scatters_ && !varies(); }
  double reference() const { return reference_; }
  double mu_t() const { return mu_t_; }
  /// Whether the extinction varies, by a density grid or by labels.
  bool varies() const { return grid_ || labels_; }
  /// Lower bound of the extinction; 0 if it varies, because parts may be empty.
  double least_extinction() const { return varies() ? 0 : mu_t_; }
  double majorant() const { return mu_t_ * largest_; }

  /// Samples whether a tentative collision at x is real. Tentative collisions have the density
  /// majorant() along a path.
  bool accepts(const Vec3& x, RandomStream& random) const {
    return !varies() || random.uniform() * largest_ < relative(x);
  }

  /// Samples whether a tentative collision at x is real. In a medium that does not scatter no
  /// collision is real; the weight is reduced instead.
  bool collides(const Vec3& x, double& weight, RandomStream& random) const {
    if (scatters_) return accepts(x, random);
    weight *= lacking(x);
    return false;
  }

  /// Probability that a tentative collision at x is null, that is, not real.
  double lacking(const Vec3& x) const { return 1 - relative(x) / largest_; }

  /// Samples the arc length to the next collision along a path x(s) by Woodcock tracking; infinity
  /// if it is beyond `longest`.
  template <class Path>
  double free_path(const Path& x, double longest, RandomStream& random) const {
    if (!scatters_) return std::numeric_limits<double>::infinity();
    double s = sample_free_flight(majorant(), random.uniform());
    while (s < longest && !accepts(x(s), random))
      s += sample_free_flight(majorant(), random.uniform());
    return s < longest ? s : std::numeric_limits<double>::infinity();
  }

  /// Returns exp(-integral of mu_t) along the path; if the extinction varies, an unbiased
  /// estimate of it by ratio tracking.
  template <class Path>
  double transmitted(const Path& x, double length, RandomStream& random) const {
    if (!(mu_t_ > 0)) return 1;
    return varies() ? ratio_tracked(x, length, random) : transmittance(mu_t_, length);
  }

 private:
  /// Extinction at x relative to mu_t().
  double relative(const Vec3& x) const {
    return grid_ ? (*grid_)(x) : labels_->at(x).mu_t() / mu_t_;
  }
  template <class Path>
  double ratio_tracked(const Path& x, double length, RandomStream& random) const {
    double left = 1;
    for (double s = sample_free_flight(majorant(), random.uniform()); s < length && left > 0;
         s += sample_free_flight(majorant(), random.uniform()))
      left *= lacking(x(s));
    return left;
  }

  std::shared_ptr<const DensityGrid> grid_;
  std::shared_ptr<const LabelledMedia> labels_;
  double mu_t_ = 0, largest_ = 1, reference_ = 0;
  bool scatters_ = false;
};

}  // namespace flatspeckle::grin

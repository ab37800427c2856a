#include "grin/design/objectives/fibre_target.h"

#include "core/run/interrupt.h"
#include "grin/design/objectives/design_objective.h"
#include "grin/design/objectives/even_points.h"

namespace flatspeckle::grin::design {

namespace {

/// Objective that all measurements are equal. Residuals are the relative deviations of the
/// measurements from their mean.
class EqualObjective : public DesignObjective {
 public:
  std::vector<double> residuals(std::span<const double> measurements) override {
    mean_ = mean(measurements);
    of_mean_.clear();
    for (const double measurement : measurements) of_mean_.push_back(measurement / mean_);
    std::vector<double> apart;
    for (const double measurement : measurements) apart.push_back((measurement - mean_) / mean_);
    return apart;
  }
  std::vector<double> times(std::span<const double> measurements) const override {
    const double change = mean(measurements);
    std::vector<double> changes;
    for (std::size_t i = 0; i < measurements.size(); ++i)
      changes.push_back((measurements[i] - of_mean_[i] * change) / mean_);
    return changes;
  }
  std::vector<double> transposed(std::span<const double> residuals) const override {
    double sum = 0;  // -sum / mean is the derivative with respect to the mean
    for (std::size_t i = 0; i < residuals.size(); ++i) sum += of_mean_[i] * residuals[i];
    std::vector<double> by_measurements;
    for (const double r : residuals)
      by_measurements.push_back((r - sum / static_cast<double>(residuals.size())) / mean_);
    return by_measurements;
  }
  std::vector<double> weights() const override {
    return std::vector<double>(of_mean_.size(), 1 / mean_);
  }

 private:
  double mean_ = 1;
  std::vector<double> of_mean_;  ///< measurements divided by their mean
};

/// Rays that fill all modes of a fibre evenly, if its profile is approximated by a parabola. Seen
/// along the axis, rays in a parabolic profile are ellipses with semiaxes a >= b. The rays are
/// distributed evenly in (a^2 + b^2)^2 and in 2 a b / (a^2 + b^2). Meridional rays have b = 0.
class FibreTarget : public DesignTarget {
 public:
  FibreTarget(const GradedProfile::Core& core, bool is_meridional, int count)
      : core_(core), is_meridional_(is_meridional), count_(count) {}

  double rays() const override { return count_; }
  int measurements() const override { return 1; }

  DesignTask task(const RayWalk& walk, bool held_out) const override {
    const int count = held_out ? count_ * 3 / 4 + 1 : count_;
    std::vector<DesignRay> rays;
    rays.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      stop_if_interrupted();
      rays.push_back(ray(even_share(i, count), std::fmod(golden_ratio * i + 0.3, 1)));
    }
    std::vector<PathPerLengthMeasurement> measurements(rays.size(), PathPerLengthMeasurement{0});
    return {make_ray_system(std::move(rays), std::move(measurements), walk),
            std::make_unique<EqualObjective>()};
  }

 private:
  DesignRay ray(double energy_share, double spin) const {
    if (is_meridional_) return from(core_.radius * energy_share, 0);
    const double size = core_.radius * std::pow(energy_share, 0.25);  // sqrt(a^2 + b^2)
    const double sum = std::sqrt(1 + spin), difference = std::sqrt(1 - spin);
    return from(size * (sum + difference) / 2, size * (sum - difference) / 2);
  }
  /// Returns the ray that starts at its largest distance a from the axis. In a parabolic profile,
  /// its smallest distance from the axis is b.
  DesignRay from(double a, double b) const {
    const double n0 = 1 + core_.axis_excess,
                 n = n0 * std::sqrt(1 - 2 * core_.delta * a * a / area());
    const double momentum = n0 * std::sqrt(2 * core_.delta) * b / core_.radius;
    return {Vec3(a, 0, 0), Vec3(0, momentum, std::sqrt(n * n - momentum * momentum)),
            Turn{Vec3::Zero()}};
  }
  double area() const { return core_.radius * core_.radius; }

  GradedProfile::Core core_;
  bool is_meridional_;
  int count_;
};

}  // namespace

void add_keys(Keys& keys, FibreValues& values) {
  keys.add("modes", values.modes,
           "all: rays that fill all modes evenly; meridional: only rays that cross the axis")
      .one_of({"all", "meridional"});
  keys.add("ray_count", values.ray_count, "Number of rays").from(3, 1'000'000);
}

std::unique_ptr<DesignTarget> make_target(const Keys& keys, const FibreValues& values,
                                          const FieldForm& form) {
  const auto* guide = std::get_if<GuideForm>(&form);
  if (!guide) throw InputError("goal", "equal_path", "requires design = guide");
  return std::make_unique<FibreTarget>(guide->core, keys.read(values.modes) == "meridional",
                                       static_cast<int>(keys.read(values.ray_count)));
}

}  // namespace flatspeckle::grin::design

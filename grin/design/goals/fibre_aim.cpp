#include "grin/design/goals/fibre_aim.h"

#include "grin/design/goals/even_points.h"
#include "grin/design/goals/goal.h"

namespace flatspeckle::grin::design {

namespace {

/// Readings are to be the same, whatever that is: residuals are their distances from their mean,
/// over it.
class EqualGoal : public Goal {
 public:
  std::vector<double> residuals(std::span<const double> readings) override {
    mean_ = mean(readings);
    of_mean_.clear();
    for (const double reading : readings) of_mean_.push_back(reading / mean_);
    std::vector<double> apart;
    for (const double reading : readings) apart.push_back((reading - mean_) / mean_);
    return apart;
  }
  std::vector<double> times(std::span<const double> readings) const override {
    const double change = mean(readings);
    std::vector<double> changes;
    for (std::size_t i = 0; i < readings.size(); ++i)
      changes.push_back((readings[i] - of_mean_[i] * change) / mean_);
    return changes;
  }
  std::vector<double> transposed(std::span<const double> residuals) const override {
    double sum = 0;  // by the mean
    for (std::size_t i = 0; i < residuals.size(); ++i) sum += of_mean_[i] * residuals[i];
    std::vector<double> by_readings;
    for (const double r : residuals)
      by_readings.push_back((r - sum / static_cast<double>(residuals.size())) / mean_);
    return by_readings;
  }
  std::vector<double> weights() const override {
    return std::vector<double>(of_mean_.size(), 1 / mean_);
  }

 private:
  double mean_ = 1;
  std::vector<double> of_mean_;  ///< readings over their mean
};

/// Light that fills all modes evenly, in the parabola that profiles of a fibre are near to: rays
/// are ellipses about the axis of semiaxes a >= b, evenly in (a^2 + b^2)^2 and in 2 a b over
/// a^2 + b^2. Of meridional rays b is 0.
class FibreAim : public Aim {
 public:
  FibreAim(const GradedProfile::Core& core, bool is_meridional, int count)
      : core_(core), is_meridional_(is_meridional), count_(count) {}

  double rays() const override { return count_; }
  int readings() const override { return 1; }

  DesignTask task(const RayWalk& walk, bool held_out) const override {
    const int count = held_out ? count_ * 3 / 4 + 1 : count_;
    std::vector<DesignRay> rays;
    for (int i = 0; i < count; ++i)
      rays.push_back(ray(even_share(i, count), std::fmod(golden_ratio * i + 0.3, 1)));
    std::vector<PathPerLengthReading> readings(rays.size(), PathPerLengthReading{0});
    return {make_ray_system(std::move(rays), std::move(readings), walk),
            std::make_unique<EqualGoal>()};
  }

 private:
  DesignRay ray(double energy_share, double spin) const {
    if (is_meridional_) return from(core_.radius * energy_share, 0);
    const double size = core_.radius * std::pow(energy_share, 0.25);  // sqrt(a^2 + b^2)
    const double sum = std::sqrt(1 + spin), difference = std::sqrt(1 - spin);
    return from(size * (sum + difference) / 2, size * (sum - difference) / 2);
  }
  /// Where it is farthest, a, with the slope that takes it to b in the parabola.
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
  keys.add("modes", values.modes, "Rays of all modes, filled evenly, or those that cross the axis")
      .one_of({"all", "meridional"});
  keys.add("ray_count", values.ray_count, "Rays of them").from(3, 1'000'000);
}

std::unique_ptr<Aim> make_aim(const Keys& keys, const FibreValues& values, const FieldForm& form) {
  const auto* guide = std::get_if<GuideForm>(&form);
  if (!guide) throw InputError("goal", "equal_path", "needs design = guide");
  return std::make_unique<FibreAim>(guide->core, keys.read(values.modes) == "meridional",
                                    static_cast<int>(keys.read(values.ray_count)));
}

}  // namespace flatspeckle::grin::design

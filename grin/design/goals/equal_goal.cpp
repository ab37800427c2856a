#include "grin/design/goals/equal_goal.h"

#include "grin/design/system/vectors.h"

namespace flatspeckle::grin::design {

namespace {

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

}  // namespace

std::unique_ptr<Goal> make_equal_goal() {
  return std::make_unique<EqualGoal>();
}

}  // namespace flatspeckle::grin::design

#include "grin/design/goals/equal_goal.h"

#include <numeric>

namespace flatspeckle::grin::design {

namespace {

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

class EqualGoal : public Goal {
 public:
  std::vector<double> residuals(std::span<const double> readings) override {
    mean_ = mean_of(readings);
    count_ = readings.size();
    return apart(readings);
  }
  /// What the mean that divides changes is of second order.
  std::vector<double> times(std::span<const double> readings) const override {
    return apart(readings);
  }
  std::vector<double> transposed(std::span<const double> residuals) const override {
    return apart(residuals);
  }
  std::vector<double> weights() const override { return std::vector<double>(count_, 1 / mean_); }

 private:
  std::vector<double> apart(std::span<const double> values) const {
    const double mean = mean_of(values);
    std::vector<double> apart(values.begin(), values.end());
    for (double& v : apart) v = (v - mean) / mean_;
    return apart;
  }

  double mean_ = 1;
  std::size_t count_ = 0;
};

}  // namespace

std::unique_ptr<Goal> make_equal_goal() {
  return std::make_unique<EqualGoal>();
}

}  // namespace flatspeckle::grin::design

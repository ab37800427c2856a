#include "grin/design/goals/goal.h"

#include <utility>

namespace flatspeckle::grin::design {

namespace {

class TargetGoal : public Goal {
 public:
  explicit TargetGoal(std::vector<double> targets) : targets_(std::move(targets)) {}

  std::vector<double> residuals(std::span<const double> readings) override {
    std::vector<double> apart(readings.begin(), readings.end());
    for (std::size_t i = 0; i < apart.size(); ++i) apart[i] -= targets_[i];
    return apart;
  }
  std::vector<double> times(std::span<const double> readings) const override {
    return {readings.begin(), readings.end()};
  }
  std::vector<double> transposed(std::span<const double> residuals) const override {
    return {residuals.begin(), residuals.end()};
  }
  bool is_plain() const override { return true; }
  std::vector<double> weights() const override { return std::vector<double>(targets_.size(), 1.0); }

 private:
  std::vector<double> targets_;
};

}  // namespace

std::unique_ptr<Goal> make_target_goal(std::vector<double> targets) {
  return std::make_unique<TargetGoal>(std::move(targets));
}

}  // namespace flatspeckle::grin::design

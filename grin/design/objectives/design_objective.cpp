#include "grin/design/objectives/design_objective.h"

#include <utility>

namespace flatspeckle::grin::design {

namespace {

class TargetObjective : public DesignObjective {
 public:
  explicit TargetObjective(std::vector<double> targets) : targets_(std::move(targets)) {}

  std::vector<double> residuals(std::span<const double> measurements) override {
    std::vector<double> apart(measurements.begin(), measurements.end());
    for (std::size_t i = 0; i < apart.size(); ++i) apart[i] -= targets_[i];
    return apart;
  }
  std::vector<double> times(std::span<const double> measurements) const override {
    return {measurements.begin(), measurements.end()};
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

std::unique_ptr<DesignObjective> make_target_objective(std::vector<double> targets) {
  return std::make_unique<TargetObjective>(std::move(targets));
}

}  // namespace flatspeckle::grin::design

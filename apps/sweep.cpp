#include "apps/command/subcommands.h"
#include "apps/experiments/experiment_sweep.h"
#include "apps/sweep/run_sweep.h"

namespace flatspeckle::apps {

namespace {

class SweepCall : public Call {
 public:
  explicit SweepCall(const std::string& of) : sweep_(make_sweep(of)) {}

  Subcommand& command() override { return sweep_->command(); }
  int run() override { return sweep_->read() ? run_sweep(*sweep_) : ExitStatus::done; }

 private:
  std::unique_ptr<Sweep> sweep_;
};

}  // namespace

std::unique_ptr<Call> sweep(const std::string& of) {
  return std::make_unique<SweepCall>(of);
}

}  // namespace flatspeckle::apps

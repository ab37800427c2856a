#include <cmath>
#include <cstdio>

#include "apps/command/subcommands.h"
#include "core/run/interrupt.h"
#include "core/run/progress.h"
#include "core/session/session.h"
#include "grin/design/design_datasets.h"

namespace flatspeckle::apps {

namespace {

using grin::design::DesignCheck;
using grin::design::Designer;
using grin::design::DesignScene;
using grin::design::DesignState;

std::string progress_of(const DesignState& state) {
  char text[80];
  std::snprintf(text, sizeof text, "%zu coefficients, rays miss by %.3g",
                state.search.coefficients.size(), state.history.rms.back());
  return text;
}

/// Nothing where a signal came.
std::optional<DesignState> search(Designer& designer) {
  Progress progress("design", "steps");
  const Stopwatch clock;
  DesignState state = designer.begin();
  while (!state.ended && !interrupted()) {
    designer.advance(state);
    const double steps = static_cast<double>(state.history.rms.size() - 1);
    const Progress::Figures figures{
        .done = progress_of(state), .samples = steps, .rate = steps / clock.seconds()};
    state.ended ? progress.finish(clock.seconds(), figures)
                : progress.update(clock.seconds(), figures);
  }
  if (!state.ended) return std::nullopt;
  return state;
}

void print_summary(const DesignState& state, const DesignCheck& check) {
  const auto print = [](const char* what, const std::optional<double>& rms,
                        const std::optional<double>& half) {
    if (rms && half)
      std::printf("%s miss by %.3g, by half the step %.3g\n", what, *rms, *half);
    else
      std::printf("%s: some do not come to their end\n", what);
  };
  std::printf("%zu coefficients, each ray traced %.0f times\n", state.search.coefficients.size(),
              state.history.traces.back());
  print("rays of the search", check.seen, check.seen_half_step);
  print("held-out rays", check.held_out, check.held_out_half_step);
}

bool is_reached(const DesignScene& scene, const DesignState& state, const DesignCheck& check) {
  if (state.stalled || !check.held_out_half_step || !check.seen_half_step) return false;
  return scene.target == 0 || state.history.rms.back() <= scene.target;
}

std::optional<Made> make(const DesignScene& scene, ResultFile& file) {
  Designer designer(scene);
  const auto state = search(designer);
  if (!state) return std::nullopt;
  const DesignCheck check = designer.check(*state);
  write_design(file, scene, designer.form(*state), *state, check);
  print_summary(*state, check);
  const bool reached = is_reached(scene, *state, check);
  if (!reached)
    std::puts(state->stalled ? "the search stalled" : "stopped before the target was reached");
  return Made{"Gauss-Newton steps, damped; derivatives by reversed rays",
              state->history.traces.back(),
              reached ? ExitStatus::done : ExitStatus::error_not_reached};
}

}  // namespace

int design(const Arguments& arguments) {
  grin::design::DesignValues values;
  RunSettings run;
  Subcommand command("design", "An index field from what its light should do");
  Keys& keys = command.keys();
  add_keys(keys, values);
  add_thread_key(keys, run);
  add_output_key(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;

  const Session session(command.text(), keys, run, command.only_prints());
  const DesignScene scene = make_design_scene(keys, values);
  if (!command.settle()) return ExitStatus::done;
  catch_interrupts();
  return session.once(ResultFile(session.out()),
                      [&](ResultFile& file) { return make(scene, file); });
}

}  // namespace flatspeckle::apps

#include "grin/design/designer.h"

#include <cmath>

#include "core/run/stopwatch.h"

namespace flatspeckle::grin::design {

Designer::Designer(const DesignScene& scene)
    : scene_(scene),
      seen_(scene.light.task(scene.walk, false)),
      held_out_(scene.light.task(scene.walk, true)) {}

FieldForm Designer::form(const DesignState& state) const {
  FieldForm form = scene_.form;
  for (int i = 0; i < state.level; ++i)
    form = std::visit([](const auto& f) -> FieldForm { return f.finer(); }, form);
  return form;
}

DesignState Designer::begin() {
  DesignState state;
  LeastSquares search(*seen_.rays, *seen_.goal, scene_.form, scene_.search);
  state.search =
      search.begin(std::vector<double>(shape_of(scene_.form).size(), scene_.start_excess));
  note(state);
  return state;
}

void Designer::note(DesignState& state) const {
  state.history.rms.push_back(std::sqrt(state.search.loss));
  state.history.traces.push_back(static_cast<double>(state.search.traces));
  state.history.cpu_s.push_back(process_cpu_seconds());
  state.history.coefficients.push_back(state.search.coefficients.size());
}

void Designer::refine(DesignState& state) {
  state.search.coefficients = finer(form(state), state.search.coefficients).coefficients;
  state.search.damping = scene_.search.first_damping;
  state.slow_steps = 0;
  ++state.level;
}

void Designer::advance(DesignState& state) {
  constexpr double slow = 0.9;  // of the root mean square, in a step
  constexpr int most_slow_steps = 2;
  LeastSquares search(*seen_.rays, *seen_.goal, form(state), scene_.search);
  const double before = state.search.loss;
  const SearchStep step = search.advance(state.search);
  note(state);
  state.stalled = step == SearchStep::stalled;
  const double rms = std::sqrt(state.search.loss);
  const bool is_enough = rms <= scene_.target;
  const bool gained = rms <= slow * std::sqrt(before);
  state.slow_steps = gained ? 0 : state.slow_steps + 1;
  const bool is_slow = step != SearchStep::better || state.slow_steps == most_slow_steps;
  const bool is_last = state.level + 1 == scene_.levels;
  const bool is_spent = static_cast<int>(state.history.rms.size()) > scene_.iterations;
  state.ended = is_spent || (is_last && (is_slow || is_enough));
  if (!state.ended && (is_slow || is_enough)) refine(state);
}

std::optional<double> Designer::rms(DesignTask& task, const DesignState& state, int parts) const {
  const auto readings = task.rays->trace(form(state), state.search.coefficients, parts);
  if (!readings) return std::nullopt;
  double sum = 0;
  for (const double r : task.goal->residuals(*readings)) sum += r * r;
  return std::sqrt(sum / static_cast<double>(task.rays->rays()));
}

DesignCheck Designer::check(const DesignState& state) {
  return {rms(seen_, state, 1), rms(seen_, state, 2), rms(held_out_, state, 1),
          rms(held_out_, state, 2)};
}

}  // namespace flatspeckle::grin::design

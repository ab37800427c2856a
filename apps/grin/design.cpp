#include <cstdio>
#include <filesystem>

#include "apps/command/subcommands.h"
#include "core/result/version.h"
#include "core/run/interrupt.h"
#include "core/run/progress.h"
#include "core/session/session.h"
#include "grin/design/problem/design_datasets.h"
#include "grin/design/problem/designer.h"

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

/// File from which an interrupted search continues, and the identity of the search.
struct Kept {
  std::filesystem::path path;
  std::string identity;
  bool resumes;
};

DesignState start(Designer& designer, const Kept& kept) {
  if (kept.resumes)
    if (auto state = grin::design::read_state(kept.path, kept.identity)) return std::move(*state);
  return designer.begin();
}

/// Prints a note if the file of an interrupted search exists but is not continued by this call.
void note_unfinished(const Kept& kept) {
  if (kept.resumes || !std::filesystem::exists(kept.path)) return;
  const bool is_this = grin::design::holds(kept.path, kept.identity);
  std::fprintf(stderr, "note: %s contains a part of %s\n", kept.path.c_str(),
               is_this ? "this search, which starts again; --resume would continue it"
                       : "another search, which is discarded");
}

/// Makes one step of the search. Returns false, and leaves the state unchanged, if a signal has
/// interrupted the step.
bool advance(Designer& designer, DesignState& state) {
  if (interrupted()) return false;
  DesignState next = state;
  try {
    designer.advance(next);
  } catch (const Interrupted&) {
    return false;
  }
  state = std::move(next);
  return true;
}

/// Runs the search until it ends or a signal arrives, and returns its state. The state is saved
/// about once a second.
DesignState search(Designer& designer, const Kept& kept) {
  constexpr double pause = 1;
  Progress progress("design", "steps");
  const Stopwatch clock;
  double saved = 0;
  DesignState state = start(designer, kept);
  const std::size_t before = state.history.rms.size();
  while (!state.ended && advance(designer, state)) {
    const double steps = static_cast<double>(state.history.rms.size() - before);
    const Progress::Figures figures{
        .done = progress_of(state), .samples = steps, .rate = steps / clock.seconds()};
    state.ended ? progress.finish(clock.seconds(), figures)
                : progress.update(clock.seconds(), figures);
    if (state.ended || clock.seconds() < saved + pause) continue;
    grin::design::save_state(kept.path, kept.identity, state);
    saved = clock.seconds();
  }
  if (!state.ended) grin::design::save_state(kept.path, kept.identity, state);
  return state;
}

void print_summary(const DesignScene& scene, const DesignState& state, const DesignCheck& check) {
  const bool of_pictures = scene.goal == grin::design::ScreenValues::word;
  const auto print = [&](const char* what, const std::optional<double>& rms,
                         const std::optional<double>& half) {
    if (rms && half && of_pictures)
      std::printf(
          "%s: pictures differ by %.3g %% of their largest value (RMS), with half the ray "
          "step by %.3g %%\n",
          what, 100 * *rms, 100 * *half);
    else if (rms && half)
      std::printf("%s miss their targets by %.3g (RMS), with half the ray step by %.3g\n", what,
                  *rms, *half);
    else
      std::printf("%s: some do not reach their target; a smaller aperture excludes grazing rays\n",
                  what);
  };
  std::printf("%zu coefficients, each ray traced %.0f times\n", state.search.coefficients.size(),
              state.history.traces.back());
  print("rays of the search", check.seen, check.seen_half_step);
  print("held-out rays", check.held_out, check.held_out_half_step);
  if (!check.held_out_half_step) return;
  const double times = check.start_held_out / *check.held_out_half_step;
  if (of_pictures)
    std::printf("at the start, pictures of held-out rays differed by %.3g %%: %.3g times as much\n",
                100 * check.start_held_out, times);
  else
    std::printf("at the start, held-out rays missed by %.3g: %.3g times as much\n",
                check.start_held_out, times);
}

/// Prints a factor times each value with this format, separated by commas.
void print_list(const char* format, const std::vector<double>& values, double factor = 1) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::fputs(i == 0 ? " " : ", ", stdout);
    std::printf(format, factor * values[i]);
  }
}

/// Prints what the objective is usually judged by: dB and light of pictures, the exponent of a
/// guide.
void print_figures(const DesignScene& scene, const Designer& designer, const DesignState& state,
                   const DesignCheck& check) {
  if (const auto* screens =
          dynamic_cast<const grin::design::ScreenTarget*>(scene.design_target.get());
      screens && check.measurements) {
    const auto [psnr_db, on_screen] = picture_quality(*screens, *check.measurements);
    std::fputs("pictures of held-out rays:", stdout);
    print_list("%.2f dB", psnr_db);
    std::fputs(" (peak signal-to-noise ratio)\nlight of held-out rays on the screens:", stdout);
    print_list("%.2f %%", on_screen, 100);
    std::puts("");
  }
  const grin::design::FieldForm form = designer.form(state);
  if (const auto* guide = std::get_if<grin::design::GuideForm>(&form);
      guide && guide->coefficients == 0)
    std::printf("exponent of the profile %.6g\n", state.search.coefficients.front());
  if (scene.focus)
    if (const auto length = focal_length(scene, designer, state))
      std::printf("effective focal length %.6g, by a ray at a tenth of the radius\n", *length);
}

void print_end(const DesignScene& scene, const DesignState& state) {
  std::printf("ended after %zu steps by the rule: %s", state.history.rms.size() - 1,
              state.ended_by.c_str());
  if (state.ended_by == "tolerance")
    std::printf(" (two steps reduced the residual by less than %.3g %%)", 100 * scene.tolerance);
  std::puts("");
}

void print_throughput(const DesignScene& scene, const DesignCheck& check) {
  if (scene.goal == grin::design::ThroughputValues::word)
    std::printf("%.4g %% of the held-out rays pass through the aperture\n", 100 * check.in_place);
}

void note_bounds(std::size_t count, const DesignScene& scene) {
  if (count == 0) return;
  if (std::holds_alternative<grin::design::GuideForm>(scene.start.form))
    std::fprintf(stderr, "note: %zu coefficients are at the limit of their range\n", count);
  else
    std::fprintf(
        stderr,
        "note: %zu coefficients are at least_index or most_index: other bounds may do better\n",
        count);
}

void note_unseen(std::size_t count) {
  if (count > 0)
    std::fprintf(stderr,
                 "note: %zu coefficients within the field are crossed by no ray and determined "
                 "only by smoothing; use more rays or fewer nodes\n",
                 count);
}

bool is_reached(const DesignScene& scene, const DesignState& state, const DesignCheck& check) {
  if (state.stalled || !check.held_out_half_step || !check.seen_half_step) return false;
  return scene.target == 0 || state.history.rms.back() <= scene.target;
}

Made make(const DesignScene& scene, const Kept& kept, ResultFile& file) {
  Designer designer(scene);
  const DesignState state = search(designer, kept);
  if (!state.ended) throw Interrupted{};
  const DesignCheck check = designer.check(state);
  write_design(file, scene, designer, state, check);
  print_end(scene, state);
  print_summary(scene, state, check);
  print_figures(scene, designer, state, check);
  print_throughput(scene, check);
  note_bounds(designer.at_bounds(state), scene);
  note_unseen(check.unseen);
  const bool reached = is_reached(scene, state, check);
  if (!reached)
    std::puts(state.stalled ? "the search stalled" : "stopped before the target was reached");
  return Made{"Gauss-Newton steps, damped; derivatives by reversed rays",
              state.history.traces.back(),
              reached ? ExitStatus::done : ExitStatus::error_not_reached};
}

struct DesignKeys {
  grin::design::DesignValues design;
  RunSettings run;
};

void add_keys(Keys& keys, DesignKeys& values) {
  add_keys(keys, values.design);
  add_thread_key(keys, values.run);
  keys.add("resume", values.run.resume, "Continue an interrupted search, if there is one").effort();
  add_output_key(keys, values.run);
}

int search_design(const Subcommand& command, DesignKeys& values) {
  const Keys& keys = command.keys();
  const Session session(command.text(), keys, values.run, command.only_prints());
  const DesignScene scene = make_design_scene(keys, values.design);
  if (!command.settle()) return ExitStatus::done;
  catch_interrupts();
  const Kept kept{grin::design::state_path(session.out()),
                  "flatspeckle " + version() + '\n' + keys.identity() + inputs_text(keys),
                  values.run.resume};
  note_unfinished(kept);
  const int status = session.once(ResultFile(session.out()),
                                  [&](ResultFile& file) { return make(scene, kept, file); });
  if (status != ExitStatus::interrupted_for_good) {
    std::filesystem::remove(kept.path);
    return status;
  }
  if (!grin::design::holds(kept.path, kept.identity)) return status;
  std::printf("interrupted; progress is saved in %s; continue with --resume\n", kept.path.c_str());
  return ExitStatus::interrupted_resumable;
}

}  // namespace

std::unique_ptr<Call> design(const std::string&) {
  return call_with<DesignKeys>("design", "Designs an index field for given paths of light",
                               search_design);
}

}  // namespace flatspeckle::apps

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "apps/command/command_line.h"
#include "apps/command/subcommands.h"
#include "apps/fit/fit_keys.h"
#include "apps/fit/fit_summary.h"
#include "apps/results/estimation.h"
#include "apps/results/view_power.h"
#include "apps/sweep/sweep_points.h"
#include "core/keys/number_text.h"
#include "core/result/guarded_read.h"
#include "core/result/version.h"
#include "core/run/interrupt.h"
#include "core/run/progress.h"
#include "core/run/stopwatch.h"
#include "core/session/journal.h"
#include "core/session/session.h"
#include "mc/fit/fit_datasets.h"
#include "mc/fit/medium_fit.h"
#include "mc/fit/plan/fit_plan.h"
#include "mc/fit/task/fit_data.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::apps {

namespace {

// letter of the records that contain the steps of a search (see Journal)
constexpr char step_kind = 's';

std::vector<std::byte> record_of(const mc::FitStep& step) {
  ByteWriter record;
  record.put(step.start);
  record.put(step.iteration);
  for (const double value : {step.paths, step.damping, step.chi_squared, step.cpu_s})
    record.put(value);
  record.put(std::vector<double>(step.at.begin(), step.at.end()));
  return record.take();
}

mc::FitStep step_of(ByteReader& record) {
  mc::FitStep step;
  record.get(step.start);
  record.get(step.iteration);
  for (double* value : {&step.paths, &step.damping, &step.chi_squared, &step.cpu_s})
    record.get(*value);
  const auto at = record.get<std::vector<double>>();
  step.at = Eigen::Map<const Eigen::VectorXd>(at.data(), std::ssize(at));
  return step;
}

/// Progress of several plans, which take about the same number of solutions of transport.
class PlanProgress {
 public:
  explicit PlanProgress(std::size_t plans) : plans_(plans) {}

  /// Returns the function that a plan calls after each solution.
  std::function<void(std::size_t, std::size_t)> of_plan(std::size_t number) {
    return [this, number](std::size_t solved, std::size_t of) {
      const double wall = watch_.seconds();
      const auto done = static_cast<double>(number * of + solved),
                 all = static_cast<double>(plans_ * of);
      progress_.update(wall, {.done = plans_ > 1 ? std::to_string(number) + " of " +
                                                       std::to_string(plans_) + " plans"
                                                 : "",
                              .samples = done,
                              .rate = done / wall,
                              .seconds_left = wall * (all / done - 1)});
    };
  }

 private:
  std::size_t plans_;
  Stopwatch watch_;
  Progress progress_{"plan", "solutions"};
};

/// Progress of a fit: how many media the search has computed, and the least chi^2 among them.
class FitProgress {
 public:
  void add(double chi_squared) {
    least_ = std::min(least_, chi_squared);
    figures_.samples += 1;
    const double wall = watch_.seconds();
    if (!progress_.due(wall)) return;
    shown_ = true;
    const std::string time = number_text(std::round(wall)) + " s";
    char least[32] = "";
    if (std::isfinite(least_)) std::snprintf(least, sizeof least, ", chi^2 %.4g so far", least_);
    figures_.done = time + least;
    figures_.rate = figures_.samples / wall;
    progress_.update(wall, figures_);
  }
  /// Ends the line, if it was printed.
  void end() {
    if (shown_) progress_.finish(watch_.seconds(), figures_);
  }

 private:
  double least_ = std::numeric_limits<double>::infinity();
  bool shown_ = false;
  Progress::Figures figures_;
  Stopwatch watch_;
  Progress progress_{"fit", "media"};
};

/// Makes and prints plans of a measurement for all combinations of the varied keys. Returns the
/// exit status.
int run_plans(const Session& session, const Subcommand& command, const FitKeys& values) {
  const Keyed<mc::MovingSpec> medium(values.medium);
  const SweepPoints points = varied_points(command.keys(), values.varied, medium.keys);
  std::vector<mc::PlanTask> tasks;
  for (std::size_t i = 0; i < points.count(); ++i) {
    const Keyed<mc::MovingSpec> there(values.medium);
    set_point(points, i, there.keys);
    there.keys.check();
    tasks.push_back(plan_of(command.keys(), values, there.values));
  }
  if (!command.settle()) return ExitStatus::done;
  return session.once(ResultFile(session.out()), [&](ResultFile& file) {
    std::vector<mc::PlanPoint> plans;
    PlanProgress progress(points.count());
    for (std::size_t i = 0; i < points.count(); ++i) {
      tasks[i].solved = progress.of_plan(i);
      plans.push_back({points.name(i), mc::fit_plan(tasks[i])});
    }
    mc::write_plans(file, tasks.front(), plans);
    print_plans(tasks.front(), plans);
    return Made{"information of circular Gaussian fields; transport through slabs"};
  });
}

int run_plan(const Session& session, const Subcommand& command, const FitKeys& values) {
  if (!values.varied.vary.empty()) return run_plans(session, command, values);
  mc::PlanTask task = plan_of(command.keys(), values, values.medium);
  if (!command.settle()) return ExitStatus::done;
  return session.once(ResultFile(session.out()), [&](ResultFile& file) {
    PlanProgress progress(1);
    task.solved = progress.of_plan(0);
    const mc::FitPlan plan = mc::fit_plan(task);
    mc::write_plan(file, task, plan);
    print_plan(task, plan);
    return Made{"information of circular Gaussian fields; transport through slabs"};
  });
}

/// Prints a note if tables of a laboratory are fitted by scenes in the plane that could be in
/// space.
void note_if_flat(const FitKeys& values, const mc::FitTask& task) {
  const auto is_table = [](const std::string& path) { return !path.ends_with(".h5"); };
  const auto is_flat = [](const SceneSpec& scene) {
    const Keyed<SceneSpec> keyed(scene);
    return scene.dimension == 2 && could_be_in_space(make_scene(keyed.keys, keyed.values));
  };
  if (std::ranges::any_of(values.measurements, is_table) &&
      std::ranges::any_of(middle_scenes(task), is_flat))
    note_plane();
}

void note_guessed_errors(const mc::FitTask& task) {
  for (const auto& measurement : task.measurements)
    if (measurement.guessed_independent)
      std::cerr << "note: " << measurement.name
                << " contains no covariances between the errors of its values: they are assumed "
                   "independent\n";
}

std::string model_of(const mc::FitTask& task, const mc::MediumFit& fit) {
  if (!task.paths)
    return std::string("transport through slabs, ") +
           (fit.reversed ? "reversed paths" : "no reversed paths");
  std::ostringstream text;
  text << "Monte Carlo, " << fit.paths << " paths in each run of the last step";
  return text.str();
}

/// Returns a text of all inputs on which the search for the best fit depends.
std::string identity_of(const Keys& keys, const mc::FitTask& task) {
  std::string text = version() + '\n' + keys.identity() + inputs_text(keys);
  for (const mc::Measurement& one : task.measurements)
    for (const double value : one.values) text += number_text(value) + ' ';
  return text;
}

int run_fit(const Session& session, const Subcommand& command, const FitKeys& values) {
  mc::FitTask task = task_of(command.keys(), values, session);
  if (!command.settle()) return ExitStatus::done;
  note_guessed_errors(task);
  note_if_flat(values, task);
  // Journal of the steps of the search, from which an interrupted search continues. It is removed
  // when the result is written.
  const std::filesystem::path path = session.out() + ".search";
  std::error_code none;
  std::optional<Journal> journal;
  const auto open = [&] {
    journal.emplace(
        path, JournalHead{identity_of(command.keys(), task)}, "search",
        [&](std::uint64_t, char, ByteReader& record) { task.made.push_back(step_of(record)); });
  };
  if (task.paths) {
    catch_interrupts();
    if (values.run.resume) open();
    task.keep = [&](const mc::FitStep& step) {
      if (!journal) {
        std::filesystem::remove(path, none);
        open();
      }
      journal->append(step_kind, record_of(step));
    };
  }
  const int status = session.once(ResultFile(session.out()), [&](ResultFile& file) {
    FitProgress progress;
    task.tried = [&](double chi_squared) { progress.add(chi_squared); };
    const mc::MediumFit fit = mc::fit_medium(task);
    progress.end();
    mc::write_fit(file, task, fit);
    if (task.paths)
      check_power(file, "", media_at(task, fit.coordinates).front().scene,
                  {"mc", fit.paths, 0, task.paths->seed});
    print_fit(task, fit);
    return Made{"least squares; " + model_of(task, fit), static_cast<double>(fit.residuals.size()),
                fit.converged ? ExitStatus::done : ExitStatus::error_not_reached};
  });
  if (journal && status == ExitStatus::interrupted_for_good) {
    std::printf("interrupted; %s contains the finished steps; continue with --resume\n",
                path.c_str());
    return ExitStatus::interrupted_resumable;
  }
  if (journal) std::filesystem::remove(path, none);
  return status;
}

int fit_or_plan(const Subcommand& command, FitKeys& values) {
  const Keys& keys = command.keys();
  if (!keys.read(values.compare).empty()) {
    if (command.settle()) print_compared_fits(values.compare);
    return ExitStatus::done;
  }
  const Session session(command.text(), keys, values.run, command.only_prints());
  return (keys.read(values.plan) ? run_plan : run_fit)(session, command, values);
}

}  // namespace

std::unique_ptr<Call> fit(const std::string&) {
  return call_with<FitKeys>("fit", "Estimates medium parameters, with errors, from measurements",
                            fit_or_plan);
}

}  // namespace flatspeckle::apps

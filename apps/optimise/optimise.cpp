#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "apps/command/subcommands.h"
#include "apps/experiments/at_point.h"
#include "apps/optimise/optimum.h"
#include "apps/results/datasets.h"
#include "apps/sweep/varied_points.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"
#include "core/result/version.h"
#include "core/run/interrupt.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

namespace {

namespace fs = std::filesystem;

/// What the user asks, besides the keys of what is searched.
struct OptimiseKeys {
  std::string of, maximise, minimise;
  std::vector<std::string> vary, against;
  std::optional<std::int64_t> scattered;
  std::int64_t starts = 4;
  double tolerance = 1e-3;
  RunSettings run;
};

/// In place of those of a single run.
void add_run_keys_of_search(Keys& keys, RunSettings& run) {
  add_run_keys_of_many(keys, run);
  for (const char* const name : {"samples", "target_error"})
    if (keys.find(name) != nullptr) keys.remove(name);
  keys.add("samples", run.samples, "Samples of each of the first evaluations; 32 batches at least")
      .positive();
  keys.add("target_error", run.target_error,
           "Relative error of the value at the best place, and what places may differ by that are "
           "not told apart; 2 % if not given")
      .between(0, 1);
}

constexpr std::int64_t most_scattered = 100000;

void add_keys(Keys& keys, OptimiseKeys& values) {
  add_run_keys_of_search(keys, values.run);
  keys.group("Search");
  keys.add("of", values.of,
           "The subcommand whose results are searched, all of whose keys are keys here");
  keys.add("vary", values.vary,
           "Keys to search: key=low:high or key=low:high:log between bounds, or values to choose "
           "from, key=1,2,3 or words or first:last:count; key.0 is the first value of a key of "
           "several, key.all all; one at least between bounds");
  keys.add(
      "maximise", values.maximise,
      "The number of the result to make as large as can be: a dataset as total, with the place "
      "of one number as image[3,4]");
  keys.add("minimise", values.minimise, "The same, as small as can be");
  keys.add("against", values.against,
           "Keys at values to compare the best place with, as amplitude=0: its gain over that");
  keys.add("scattered", values.scattered,
           "Places to begin with, spread evenly, and half as many again around the best of those: "
           "the more, the surer that no maximum is missed (default: 128 for one key between "
           "bounds, 256 for two, 512 for more; times the choices, at most 512 or four of each)")
      .from(2, most_scattered);
  keys.add("starts", values.starts, "Of these the best, around which the search goes on")
      .from(1, 1000);
  keys.add("key_tolerance", values.tolerance, "Of keys at the end, as a share of their ranges")
      .between(0, 1);
}

std::size_t default_scattered(const SearchAxes& axes) {
  constexpr std::size_t least = 64, usual = 512, of_each = 4;
  std::size_t count = least;
  for (std::size_t i = 0; i < axes.dimensions() && count < usual; ++i) count *= 2;
  const std::size_t choices = axes.choices();
  const std::size_t wanted = std::max(std::min(usual, count * choices), of_each * choices);
  return std::min(wanted, static_cast<std::size_t>(most_scattered));
}

std::size_t scattered_of(const std::optional<std::int64_t>& given, const SearchAxes& axes) {
  const std::size_t count = given ? static_cast<std::size_t>(*given) : default_scattered(axes);
  if (count < axes.choices())
    throw InputError("scattered", count,
                     "must be at least " + std::to_string(axes.choices()) +
                         ", the combinations of the values to choose from");
  return count;
}

/// A search as it was asked for.
class Optimisation : public Call {
 public:
  explicit Optimisation(const std::string& of)
      : family_(of),
        base_(family_.unset()),
        scene_(family_.unset()),
        command_("optimise", purpose_of(family_)) {
    values_.of = of;
    scene_->add_keys(scene_keys_);
    base_->add_keys(command_.keys());
    add_keys(command_.keys(), values_);
  }

  Subcommand& command() override { return command_; }
  int run() override {
    const Keys& keys = command_.keys();
    const Session session(command_.text(), keys, values_.run, command_.only_prints());
    read(session);
    if (!command_.settle()) return ExitStatus::done;
    return session.is_complete(identity(), fs::exists(journal())) ? ExitStatus::done
                                                                  : search(session);
  }

 private:
  static std::string purpose_of(const ExperimentFamily& family) {
    return std::string("The best values of keys of: ") + family.purpose();
  }

  void read(const Session& session) {
    const Keys& keys = command_.keys();
    keys.read(values_.of);
    axes_.emplace(keys.required(values_.vary), scene_keys_);
    read_objective();
    if (const auto& seconds = keys.read(values_.run.seconds)) settings_.seconds = *seconds;
    if (const auto& samples = keys.read(values_.run.samples))
      settings_.samples = static_cast<std::uint64_t>(*samples);
    settings_.seed = session.seed();
    settings_.threads = session.threads();
    search_.target_error = keys.read(values_.run.target_error).value_or(default_target_error);
    search_.tolerance = keys.read(values_.tolerance);
    search_.starts = static_cast<std::size_t>(keys.read(values_.starts));
    search_.scattered = scattered_of(keys.read(values_.scattered), *axes_);
    take_scene();
  }

  void read_objective() {
    const Keys& keys = command_.keys();
    const std::string &most = keys.read(values_.maximise), &least = keys.read(values_.minimise);
    if (most.empty() == least.empty())
      throw InputError("maximise, minimise: give one, a number of the result such as total");
    settings_.minimise = most.empty();
    objective_.emplace(most.empty() ? "minimise" : "maximise", most.empty() ? least : most);
  }

  /// Whether the corners are scenes; what they read of the keys counts as read.
  void take_scene() {
    const Keys& keys = command_.keys();
    std::set<std::string> own{"of",        "vary",    "maximise",      "minimise", "against",
                              "scattered", "starts",  "key_tolerance", "out",      "seed",
                              "samples",   "seconds", "target_error",  "threads",  "resume"};
    family_.take_given(keys, own);
    for (std::size_t choice = 0; choice < std::min<std::size_t>(axes_->choices(), 64); ++choice)
      for (const double at : {0.0, 1.0})
        inputs_ = checked(axes_->point({UnitPlace(axes_->dimensions(), at), choice}))->inputs();
    if (!keys.read(values_.against).empty())
      checked(point_against(axes_->point({UnitPlace(axes_->dimensions(), 0), 0})));
  }

  std::unique_ptr<Experiment> checked(const SweepPoints& point) const {
    return at_point(point, 0, [&] {
      return family_.run([&](const Keys& keys) { set_point(point, 0, keys); }, {&command_.keys()});
    });
  }

  /// The point with the keys of `against` at their values there.
  SweepPoints point_against(SweepPoints point) const {
    for (const std::string& text : values_.against) {
      const SweepAxis other = varied_axis(scene_keys_, text);
      if (other.values.size() != 1) throw InputError("against", text, "must be key=value");
      const auto same = std::ranges::find(point.axes, other.key, &SweepAxis::key);
      if (same == point.axes.end())
        point.axes.push_back(other);
      else
        same->values = other.values;
    }
    return point;
  }

  /// Of all evaluations.
  std::string identity_of_evaluations() const {
    return "flatspeckle " + version() + ", optimise of " + family_.of() + ", format 1\n" +
           family_.given() + "seed = " + std::to_string(settings_.seed) +
           "\nobjective = " + objective_->text() +
           "\nsamples = " + std::to_string(settings_.samples.value_or(0)) + '\n' + inputs_;
  }
  std::string identity() const { return identity_of_evaluations() + command_.keys().identity(); }

  fs::path journal() const { return values_.run.out + ".evaluations"; }

  int search(const Session& session);
  Optimum found(Evaluations& evaluations) const;
  int write(const Session& session, const Evaluations& evaluations, const Optimum& optimum,
            double wall_s) const;

  ExperimentFamily family_;
  std::unique_ptr<Experiment> base_, scene_;
  Keys scene_keys_;  ///< of a single run
  OptimiseKeys values_;
  Subcommand command_;
  std::optional<SearchAxes> axes_;
  std::optional<Objective> objective_;
  EvaluationSettings settings_;
  SearchSettings search_;
  std::string inputs_;
};

int Optimisation::search(const Session& session) {
  catch_interrupts();
  const fs::path journal_path = this->journal();
  if (fs::exists(journal_path) && !values_.run.resume)
    throw InputError(journal_path.string() +
                     " holds evaluations of an earlier search: --resume goes on with them; remove "
                     "it to begin again");
  const Stopwatch clock;
  EvaluationJournal journal(journal_path, {identity_of_evaluations(), command_.keys().config()});
  Evaluations evaluations(family_, *objective_, settings_, journal);
  int status = ExitStatus::interrupted_resumable;
  try {
    const Optimum optimum = found(evaluations);
    print_optimum(optimum, settings_);
    status = write(session, evaluations, optimum, clock.seconds());
    if (optimum.finished) fs::remove(journal_path);
  } catch (const Interrupted&) {
    journal.sync();
    std::cout << "interrupted; " << journal_path.string() << " holds " << journal.size()
              << " evaluations, --resume goes on\n";
  } catch (const InputError&) {  // of other bounds what there is can be gone on with
    if (journal.size() == 0) fs::remove(journal_path);
    throw;
  }
  return status;
}

Optimum Optimisation::found(Evaluations& evaluations) const {
  SearchTask task{.dimensions = axes_->dimensions(),
                  .choices = axes_->choices(),
                  .measure = {},
                  .negated = settings_.minimise};
  task.measure = [&](const std::vector<SearchPlace>& places, const SearchEffort& effort) {
    std::vector<SweepPoints> points;
    for (const SearchPlace& place : places) points.push_back(axes_->point(place));
    return evaluations.measure(points, effort);
  };
  task.tell = [&](const std::string& text) {
    std::cout << text << " (" << evaluations.all().size() << " evaluations)\n" << std::flush;
  };
  const SearchEnd end = noisy_search(task, search_);
  Optimum optimum{
      .winner = chosen_winner(task, search_, end.best), .best = {}, .runner_up = {}, .against = {}};
  const Winner& winner = optimum.winner;
  optimum.finished = end.finished;
  optimum.best = axes_->point(winner.best.place);
  optimum.runner_up = axes_->point(winner.runner_up.place);
  optimum.at_bounds = axes_->at_bounds(winner.best.place, search_.tolerance);
  if (values_.against.empty()) return optimum;
  optimum.against = point_against(optimum.best);
  optimum.there = evaluations.measure({*optimum.against}, {winner.best.samples, 2}).front();
  return optimum;
}

/// The result of the best place's own run, and beside it the search.
int Optimisation::write(const Session& session, const Evaluations& evaluations,
                        const Optimum& optimum, double wall_s) const {
  Provenance made = session.provenance();
  made.identity = identity();
  made.wall_s = wall_s;
  for (const Evaluation& one : evaluations.all()) {
    made.cpu_s += one.cpu_s;
    made.samples += one.samples;
  }
  made.converged = optimum.finished && optimum.winner.reached;
  made.plan = std::to_string(evaluations.all().size()) + " evaluations";
  ResultFile file(values_.run.out);
  const ResultGroup root(file, optimum_table);
  root.attribute("of", family_.of());
  root.attribute("objective", objective_->text());
  root.attribute("complete", optimum.finished);
  put(file, evaluations.result(optimum.best, optimum.winner.best.samples));
  write_optimum(file, optimum, evaluations, settings_, scene_keys_);
  Session::commit(file, made);
  if (made.converged) return ExitStatus::done;
  std::cout << (optimum.finished ? "the target error was not reached\n"
                                 : "the time was up; --resume goes on\n");
  return ExitStatus::error_not_reached;
}

}  // namespace

std::unique_ptr<Call> optimise(const std::string& of) {
  const auto nothing = [](const Subcommand&, OptimiseKeys&) -> int { return ExitStatus::done; };
  if (of.empty()) return call_with<OptimiseKeys>("optimise", "", nothing);
  return std::make_unique<Optimisation>(of);
}

}  // namespace flatspeckle::apps

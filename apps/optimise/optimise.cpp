#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>

#include "apps/command/subcommands.h"
#include "apps/experiments/experiment_family.h"
#include "apps/optimise/evaluations.h"
#include "apps/results/datasets.h"
#include "apps/sweep/sweep_points.h"
#include "core/error.h"
#include "core/keys/keys.h"
#include "core/keys/number_text.h"
#include "core/result/result_file.h"
#include "core/result/result_group.h"
#include "core/result/version.h"
#include "core/run/interrupt.h"
#include "core/search/noisy_search.h"
#include "core/session/journal.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

const DatasetTable optimum_table{
    .name = "optimise",
    .rows = {{"search/evaluation", Data::numbers, "", "1", "number of the evaluation"},
             {"search/value", Data::estimate, "search/evaluation", "",
              "what was made as large or small as can be"},
             {"search/samples", Data::real, "search/evaluation", "1", "samples"},
             {"search/cpu_s", Data::real, "search/evaluation", "s", "processor time, all threads"},
             {"search/draw", Data::count, "search/evaluation", "1",
              "random numbers: 0 of the search, 1 of the choice among its ends, 2 of the value"},
             {"best/value", Data::estimate, "", "",
              "the value at the best place, by random numbers of its own"},
             {"best/lead", Data::estimate, "", "", "by how much it is better than the runner-up"},
             {"best/confidence", Data::real, "", "1", "that it is better"},
             {"best/gain", Data::estimate, "", "1",
              "value at the best place over with the keys of against"},
             {"runner_up/value", Data::estimate, "", "", "the value there"},
             {"against/value", Data::estimate, "", "", "the value there"}},
    .attributes = {{"", "of", "text", "the subcommand whose results these are"},
                   {"", "objective", "text", "the number of its result that was searched for"},
                   {"", "objective_unit", "text", "of the values here"},
                   {"", "complete", "bool", "0: the time was up before the search had ended"},
                   {"search", "swept", "texts", "the keys that were searched"},
                   {"best", "at_bounds", "texts",
                    "keys whose best value is a bound of their range, if there are any: a wider "
                    "one may have a better"}}};

namespace {

/// What a search has ended in.
struct Optimum {
  Winner winner;
  SweepPoints best, runner_up;         ///< the keys there
  std::optional<SweepPoints> against;  ///< with some keys at other values
  std::optional<Measured> there = {};
  std::vector<std::string> at_bounds = {};  ///< keys of the best that a wider range may better
  bool finished = true;
};

double sign_of(const EvaluationSettings& settings) {
  return settings.minimise ? -1 : 1;
}

void put(const ResultGroup& root, const std::string& name, double value, double error) {
  root.put(name, value, error);
}

/// The keys of a place under their names, as datasets without axes; those of many as columns.
void write_keys(ResultFile& file, const std::string& group, const std::vector<SweepPoints>& points,
                const std::vector<Axis>& axes, const Keys& keys) {
  for (std::size_t i = 0; i < points.front().axes.size(); ++i) {
    const SweepAxis& axis = points.front().axes[i];
    const Key& key = *keys.find(key_of(axis));
    std::vector<std::string> texts;
    std::vector<double> values;
    for (const SweepPoints& point : points) {
      texts.push_back(point.value(i, 0));
      if (key.is_number()) values.push_back(*read_number(texts.back()));
    }
    const std::string name = group + '/' + axis_name(axis);
    const std::string unit = key.unit().empty() ? "1" : key.unit();
    if (key.is_number())
      file.dataset(name, std::span<const double>(values), axes, unit, key.help());
    else
      file.dataset(name, std::span<const std::string>(texts), axes, "", key.help());
  }
}

void write_search(ResultFile& file, const ResultGroup& root, const Evaluations& evaluations,
                  double sign, const Keys& keys) {
  const auto& all = evaluations.all();
  root.number("search/evaluation", all.size());
  std::vector<SweepPoints> points;
  std::vector<double> values, errors;
  for (const Evaluation& one : all) {
    points.push_back(one.point);
    values.push_back(sign * one.found.value);
    errors.push_back(error(one.found));
  }
  write_keys(file, "search", points, {Axis("search/evaluation")}, keys);
  root.put("search/value", std::span<const double>(values), errors);
  root.put("search/samples", column(all, &Evaluation::samples));
  root.put("search/cpu_s", column(all, &Evaluation::cpu_s));
  root.put("search/draw", column(all, [](const Evaluation& one) { return one.effort.draw; }));
  std::vector<std::string> names;
  for (const SweepAxis& axis : points.front().axes) names.push_back(axis_name(axis));
  root.attribute("search", "swept", names);
}

std::string keys_text(const SweepPoints& point) {
  std::string text;
  for (const SweepAxis& axis : point.axes)
    text += (text.empty() ? "" : ", ") + axis.key + " = " + axis.values.front();
  return text;
}

/// All that was evaluated, the best and what it is better than. keys: of what was searched.
void write_optimum(ResultFile& file, const Optimum& optimum, const Evaluations& evaluations,
                   const EvaluationSettings& settings, const Keys& keys) {
  const auto& [best, runner_up, lead, reached] = optimum.winner;
  const double sign = sign_of(settings);
  const ResultGroup root(file, optimum_table);
  root.attribute("objective_unit", evaluations.dataset().units);
  write_search(file, root, evaluations, sign, keys);
  write_keys(file, "best", {optimum.best}, {}, keys);
  if (!optimum.at_bounds.empty()) root.attribute("best", "at_bounds", optimum.at_bounds);
  put(root, "best/value", sign * best.measured.value, error(best.measured));
  write_keys(file, "runner_up", {optimum.runner_up}, {}, keys);
  put(root, "runner_up/value", sign * runner_up.measured.value, error(runner_up.measured));
  put(root, "best/lead", lead.value, lead.error);
  root.put("best/confidence", lead.confidence());
  if (!optimum.there) return;
  const Measured gain = ratio(best.measured, *optimum.there);
  write_keys(file, "against", {*optimum.against}, {}, keys);
  put(root, "against/value", sign * optimum.there->value, error(*optimum.there));
  if (optimum.there->value != 0) put(root, "best/gain", gain.value, error(gain));
}

/// On standard output.
void print_optimum(const Optimum& optimum, const EvaluationSettings& settings) {
  const auto& [best, runner_up, lead, reached] = optimum.winner;
  const double sign = sign_of(settings);
  const auto print = [&](const char* what, const SweepPoints& point, const Measured& found) {
    std::printf("%-10s %.6g +- %.2g at %s\n", what, sign * found.value, error(found),
                keys_text(point).c_str());
  };
  print("best", optimum.best, best.measured);
  const bool has_other = runner_up.place != best.place;
  if (has_other) {
    print("runner-up", optimum.runner_up, runner_up.measured);
    std::printf("better by %.3g +- %.2g, with a confidence of %.4g\n", lead.value, lead.error,
                lead.confidence());
  }
  std::puts(
      "the best that the scattered places led to: more of them (scattered), or a map, tell whether "
      "there is better");
  if (has_other && std::abs(lead.value) < 2 * lead.error)
    std::puts(
        "not told apart: their values are equal within the errors, as on a plateau; either will "
        "do (the best\nwas chosen by earlier random numbers, of which these know nothing; a "
        "smaller target_error tells more)");
  if (!optimum.at_bounds.empty())
    std::printf("at a bound of its range: %s; a wider one may have a better place\n",
                joined(optimum.at_bounds, ", ").c_str());
  if (!optimum.there) return;
  print("against", *optimum.against, *optimum.there);
  if (optimum.there->value == 0) return;
  const Measured gain = ratio(best.measured, *optimum.there);
  std::printf("%-10s %.6g +- %.2g\n", "gain", gain.value, error(gain));
}

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
    if (!session.is_complete(identity(), fs::exists(journal()))) return search(session);
    remove_journal();
    return ExitStatus::done;
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
  /// Removes the journal of this search, and of no other, which a process left that was killed once
  /// its result was there.
  void remove_journal() const try {
    Journal(journal(), identity_of_evaluations(), "search",
            [](std::uint64_t, char, ByteReader&) {});
    fs::remove(journal());
  } catch (const InputError&) {
  } catch (const IoError&) {  // no journal is there
  }

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
  std::optional<SearchObjective> objective_;
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
  Evaluations evaluations(family_, *objective_, settings_, journal_path,
                          {identity_of_evaluations(), command_.keys().config()});
  int status = ExitStatus::interrupted_resumable;
  try {
    const Optimum optimum = found(evaluations);
    print_optimum(optimum, settings_);
    status = write(session, evaluations, optimum, clock.seconds());
    if (optimum.finished) fs::remove(journal_path);
  } catch (const Interrupted&) {
    evaluations.sync();
    std::cout << "interrupted; " << journal_path.string() << " holds " << evaluations.kept()
              << " evaluations, --resume goes on\n";
  } catch (const InputError&) {  // of other bounds what there is can be gone on with
    if (evaluations.kept() == 0) fs::remove(journal_path);
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
  const CollectedResult best = evaluations.result(optimum.best, optimum.winner.best.samples);
  made.converged = optimum.finished && optimum.winner.reached && best.keeps_invariants();
  made.plan = std::to_string(evaluations.all().size()) + " evaluations";
  ResultFile file(values_.run.out);
  const ResultGroup root(file, optimum_table);
  root.attribute("of", family_.of());
  root.attribute("objective", objective_->text());
  root.attribute("complete", optimum.finished);
  put(file, best);
  write_optimum(file, optimum, evaluations, settings_, scene_keys_);
  Session::commit(file, made);
  if (made.converged) return ExitStatus::done;
  std::cout << (!optimum.finished          ? "the time was up; --resume goes on\n"
                : !best.keeps_invariants() ? "the best point's result fails its invariants\n"
                                           : "the target error was not reached\n");
  return ExitStatus::error_not_reached;
}

}  // namespace

std::unique_ptr<Call> optimise(const std::string& of) {
  const auto nothing = [](const Subcommand&, OptimiseKeys&) -> int { return ExitStatus::done; };
  if (of.empty()) return call_with<OptimiseKeys>("optimise", "", nothing);
  return std::make_unique<Optimisation>(of);
}

}  // namespace flatspeckle::apps

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>

#include "apps/command/subcommands.h"
#include "apps/experiments/experiment_kind.h"
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
             {"search/value", Data::estimate, "search/evaluation", "", "the optimised number"},
             {"search/samples", Data::real, "search/evaluation", "1", "number of samples"},
             {"search/cpu_s", Data::real, "search/evaluation", "s", "processor time, all threads"},
             {"search/draw", Data::count, "search/evaluation", "1",
              "random numbers used: 0 search, 1 selection among its final points, 2 final value"},
             {"best/value", Data::estimate, "", "",
              "value at the best point, with independent random numbers"},
             {"best/lead", Data::estimate, "", "",
              "difference between the best value and the runner-up"},
             {"best/confidence", Data::real, "", "1",
              "probability that the best point is better than the runner-up"},
             {"best/gain", Data::estimate, "", "1",
              "value at the best point divided by the value with the keys of against"},
             {"runner_up/value", Data::estimate, "", "", "value at the runner-up"},
             {"against/value", Data::estimate, "", "", "value with the keys of against"}},
    .attributes = {
        {"", "of", "text", "the subcommand whose results were optimised"},
        {"", "objective", "text", "the optimised number of its result"},
        {"", "objective_unit", "text", "unit of the values"},
        {"", "complete", "bool", "whether the search finished; 0: the time limit ended it"},
        {"search", "swept", "texts", "the optimised keys"},
        {"best", "at_bounds", "texts",
         "keys whose best value is at a bound of their range, if any: a wider range may "
         "contain a better value"}}};

namespace {

/// Outcome of a search.
struct Optimum {
  Winner winner;
  SweepPoints best, runner_up;  ///< values of the optimised keys at these points
  /// Best point, but with the values of the key `against` for some keys, for a comparison.
  std::optional<SweepPoints> against;
  std::optional<Measured> there = {};
  std::vector<std::string> at_bounds = {};  ///< names of the keys whose best value is at a bound
  bool finished = true;
};

double sign_of(const EvaluationSettings& settings) {
  return settings.minimise ? -1 : 1;
}

void put(const ResultGroup& root, const std::string& name, double value, double error) {
  root.put(name, value, error);
}

/// Writes the values of each key at these points to a dataset with the name of the key: a scalar
/// for one point, a column for several.
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

/// Writes all evaluations, the best point, the runner-up and their comparison. keys: keys of the
/// optimised subcommand.
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

/// Prints the outcome of the search on standard output.
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
      "best point found from the scattered start points; to search for a better one, increase "
      "scattered or sweep a map");
  if (has_other && std::abs(lead.value) < 2 * lead.error)
    std::puts(
        "not distinguishable: the values are equal within the errors, as on a plateau; either "
        "point is suitable\n(the best point was selected with earlier, independent random numbers; "
        "a smaller target_error resolves more)");
  if (!optimum.at_bounds.empty())
    std::printf("at a bound of its range: %s; a wider range may contain a better point\n",
                join_texts(optimum.at_bounds, ", ").c_str());
  if (!optimum.there) return;
  print("against", *optimum.against, *optimum.there);
  if (optimum.there->value == 0) return;
  const Measured gain = ratio(best.measured, *optimum.there);
  std::printf("%-10s %.6g +- %.2g\n", "gain", gain.value, error(gain));
}

namespace fs = std::filesystem;

/// Values of the keys of `optimise` itself, not of the optimised subcommand.
struct OptimiseKeys {
  std::string of, maximise, minimise;
  std::vector<std::string> vary, against;
  std::optional<std::int64_t> scattered;
  std::int64_t starts = 4;
  double tolerance = 1e-3;
  RunSettings run;
};

/// Replaces the keys of a single run (samples, seconds ...) by those of a search.
void add_run_keys_of_search(Keys& keys, RunSettings& run) {
  add_run_keys_of_many(keys, run);
  for (const char* const name : {"samples", "target_error"})
    if (keys.find(name) != nullptr) keys.remove(name);
  keys.add("samples", run.samples,
           "Number of samples of each of the first evaluations, at least 32 batches")
      .positive();
  keys.add("target_error", run.target_error,
           "Relative error of the value at the best point, and relative difference below which "
           "points are not distinguished (default: 2 %)")
      .between(0, 1);
}

constexpr std::int64_t most_scattered = 100000;

void add_keys(Keys& keys, OptimiseKeys& values) {
  add_run_keys_of_search(keys, values.run);
  keys.group("Search");
  keys.add("of", values.of,
           "Subcommand whose results are optimised; all its keys can be given here");
  keys.add("vary", values.vary,
           "Keys to optimise. Between bounds: key=low:high or key=low:high:log. From a list: "
           "key=1,2,3 or "
           "key=word,word or key=first:last:count. key.0 varies only the first value of a key with "
           "several values, key.all all of them; at least one key must be given with bounds");
  keys.add("maximise", values.maximise,
           "Value of the result to maximise: a dataset with one number such as total, or one "
           "number of a dataset such as image[3,4]");
  keys.add("minimise", values.minimise,
           "Value of the result to minimise, given in the same way as for maximise");
  keys.add("against", values.against,
           "Keys and values for a comparison, such as amplitude=0: the best point is also "
           "evaluated with these values, and the gain over them is printed");
  keys.add("scattered", values.scattered,
           "Number of points of the first scan, evenly spread; half as many are added around the "
           "best. More points reduce the risk of missing the optimum (default: 128 for one key "
           "between "
           "bounds, 256 for two, 512 for more, times the number of combinations of listed values, "
           "but at most 512 or, if that is more, four points per combination)")
      .from(2, most_scattered);
  keys.add("starts", values.starts,
           "Number of the best points of the first scan around which the search continues")
      .from(1, 1000);
  keys.add("key_tolerance", values.tolerance,
           "Tolerance to which the best values of the keys are located, as a fraction of their "
           "ranges")
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
                         ", the number of combinations of listed values");
  return count;
}

/// A call of the subcommand `optimise`.
class Optimisation : public Call {
 public:
  explicit Optimisation(const std::string& of)
      : kind_(of),
        base_(kind_.unset()),
        scene_(kind_.unset()),
        command_("optimise", purpose_of(kind_)) {
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
  static std::string purpose_of(const ExperimentKind& kind) {
    return std::string("Optimises values of keys of: ") + kind.purpose();
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
      throw InputError(
          "maximise, minimise: give exactly one of them, with a value of the result such as total");
    settings_.minimise = most.empty();
    objective_.emplace(most.empty() ? "minimise" : "maximise", most.empty() ? least : most);
  }

  /// Checks that two opposite corners of the search space are valid scenes, and marks the keys that
  /// these scenes use as read.
  void take_scene() {
    const Keys& keys = command_.keys();
    std::set<std::string> own{"of",        "vary",    "maximise",      "minimise", "against",
                              "scattered", "starts",  "key_tolerance", "out",      "seed",
                              "samples",   "seconds", "target_error",  "threads",  "resume"};
    kind_.take_given(keys, own);
    for (std::size_t choice = 0; choice < std::min<std::size_t>(axes_->choices(), 64); ++choice)
      for (const double at : {0.0, 1.0})
        inputs_ = checked(axes_->point({UnitPlace(axes_->dimensions(), at), choice}))->inputs();
    if (!keys.read(values_.against).empty())
      checked(point_against(axes_->point({UnitPlace(axes_->dimensions(), 0), 0})));
  }

  std::unique_ptr<Experiment> checked(const SweepPoints& point) const {
    return at_point(point, 0, [&] {
      return kind_.run([&](const Keys& keys) { set_point(point, 0, keys); }, {&command_.keys()});
    });
  }

  /// Returns `point` after setting the keys given in the key `against` to the values given there.
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

  /// Returns a text of all inputs on which the values of the evaluations depend.
  std::string identity_of_evaluations() const {
    return "flatspeckle " + version() + ", optimise of " + kind_.of() + ", format 1\n" +
           kind_.given() + "seed = " + std::to_string(settings_.seed) +
           "\nobjective = " + objective_->text() +
           "\nsamples = " + std::to_string(settings_.samples.value_or(0)) + '\n' + inputs_;
  }
  std::string identity() const { return identity_of_evaluations() + command_.keys().identity(); }

  fs::path journal() const { return values_.run.out + ".evaluations"; }
  /// Removes the journal of this search, which a process leaves if it is killed after writing the
  /// result. Journals of other searches are kept.
  void remove_journal() const try {
    Journal(journal(), identity_of_evaluations(), "search",
            [](std::uint64_t, char, ByteReader&) {});
    fs::remove(journal());
  } catch (const InputError&) {
  } catch (const IoError&) {  // there is no journal
  }

  int search(const Session& session);
  Optimum found(Evaluations& evaluations) const;
  int write(const Session& session, const Evaluations& evaluations, const Optimum& optimum,
            double wall_s) const;

  ExperimentKind kind_;
  std::unique_ptr<Experiment> base_, scene_;
  Keys scene_keys_;  ///< keys of a single run of the optimised subcommand
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
                     " contains evaluations of an earlier search: continue with --resume, or "
                     "remove it to start again");
  const Stopwatch clock;
  Evaluations evaluations(kind_, *objective_, settings_, journal_path,
                          {identity_of_evaluations(), command_.keys().config()});
  int status = ExitStatus::interrupted_resumable;
  try {
    const Optimum optimum = found(evaluations);
    print_optimum(optimum, settings_);
    status = write(session, evaluations, optimum, clock.seconds());
    if (optimum.finished) fs::remove(journal_path);
  } catch (const Interrupted&) {
    evaluations.sync();
    std::cout << "interrupted; " << journal_path.string() << " contains " << evaluations.kept()
              << " evaluations; continue with --resume\n";
  } catch (const InputError&) {
    // the evaluations so far are kept, because they can be used with other bounds
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
  task.report = [&](const std::string& text) {
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

/// Writes the result file: the result of the run at the best point, and the evaluations of the
/// search.
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
  root.attribute("of", kind_.of());
  root.attribute("objective", objective_->text());
  root.attribute("complete", optimum.finished);
  put(file, best);
  write_optimum(file, optimum, evaluations, settings_, scene_keys_);
  Session::commit(file, made);
  if (made.converged) return ExitStatus::done;
  std::cout << (!optimum.finished ? "time limit reached; continue with --resume\n"
                : !best.keeps_invariants()
                    ? "the result of the best point violates its invariants\n"
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

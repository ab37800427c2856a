#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "apps/command/command_line.h"
#include "apps/command/subcommands.h"
#include "apps/fit/fit_summary.h"
#include "apps/fit/measurement_file.h"
#include "apps/results/estimation.h"
#include "apps/results/view_power.h"
#include "apps/sweep/sweep_points.h"
#include "core/error.h"
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

/// Values of the keys of the subcommand `fit`.
struct FitKeys {
  mc::MovingSpec medium;
  mc::DetectorValues detectors;
  std::vector<std::string> free, measurements, compare;
  std::int64_t starts = 2, most_iterations = 60;
  std::string method = "auto";
  double model_share = 0.2;
  bool trust_paths = false;
  bool plan = false;
  double patterns = 1000;
  std::vector<std::string> choose;
  VaryValues varied;
  RunSettings run;
};

void add_keys(Keys& keys, FitKeys& values) {
  values.medium.domain = "slab";
  values.medium.scatterer = "hg";
  keys.group("Fit");
  keys.add("free", values.free,
           "Keys to fit and their bounds, such as g=0.5:0.99; the value of the key in the scene, "
           "if given, is the start value");
  keys.add("measurement", values.measurements,
           "Files to fit jointly: results of covariance, flux and sweep (.h5), or tables (CSV)")
      .file();
  keys.add("compare", values.compare,
           "Files to compare: results of fits of the same measurements with different media; "
           "requires no measurement");
  keys.add("starts", values.starts,
           "Number of grid values of each free key without a start value; the fit starts from the "
           "best grid point, and also from the next two if chi^2 is improbably large")
      .from(1, 100);
  keys.add("most_iterations", values.most_iterations, "Largest number of steps of the fit")
      .from(1, 10000);
  keys.add("method", values.method,
           "Model: transport through slabs, or mc (Monte Carlo); auto: transport if all "
           "measurements are of slabs without flow of the scatterers, else mc")
      .one_of({"transport", "mc", "auto"});
  keys.add("model_share", values.model_share,
           "Monte Carlo model: largest fraction of the variances of the estimates that its noise "
           "may cause")
      .from(0.001, 1);
  keys.add("trust_paths", values.trust_paths,
           "Trust the Monte Carlo model: do not add to the errors what its neglect of wave effects "
           "may cause");
  keys.add("plan", values.plan,
           "Plan a measurement instead of fitting one: compute the errors with which speckle in "
           "view_angles under tilts determines the free keys, at their values in the scene");
  keys.add("patterns", values.patterns,
           "Number of independent speckle patterns measured in each view")
      .positive()
      .only_of("plan");
  keys.add("choose", values.choose,
           "How many of tilts, or of view_angles, the plan may use, as tilts=12: those without "
           "which the relative errors grow least are left out")
      .only_of("plan");
  add_vary_key(keys, values.varied);
  keys.group("Plan", "plan");
  keys.add("light_angles", values.medium.light_angles, "Direction of the light, angle from +z")
      .angle();
  keys.add("view_angles", values.medium.view_angles, "Directions of the views, angles from +z")
      .angle();
  keys.add("tilts", values.medium.tilts, "Rotations of the light").angle();
  keys.group("");
  add_scatterer_keys(keys, values.medium);
  add_bulk_keys(keys, values.medium);
  add_medium_keys(keys, values.medium);
  for (const char* of_placements : {"count", "placement"}) keys.remove(of_placements);
  add_structure_key(keys, values.medium);
  add_space_keys(keys, values.medium);
  add_faces_keys(keys, values.medium);
  mc::add_motion_keys(keys, values.medium);
  keys.group("Detectors", "measurements at distances");
  mc::add_keys(keys, values.detectors);
  mc::add_scale_key(keys, values.medium);
  keys.group("");
  add_output_key(keys, values.run);
  add_seed_key(keys, values.run, "Random seed of a Monte Carlo model");
  keys.add("seconds", values.run.seconds,
           "Time after which a Monte Carlo model draws no more paths")
      .positive();
  add_thread_key(keys, values.run);
  keys.add("resume", values.run.resume,
           "Continue an interrupted search by Monte Carlo from OUT.search, if it exists")
      .effort();
}

bool is_free(const mc::FitTask& task, const std::string& key) {
  return std::ranges::find(task.free, key, &mc::FreeParameter::key) != task.free.end();
}

/// Throws InputError if the optical depth is a free parameter but the measurements have different
/// thicknesses.
void check_depths(const mc::FitTask& task) {
  std::set<double> depths;
  for (const auto& measurement : task.measurements)
    for (const auto& curve : measurement.curves) depths.insert(curve.scene.depth.value_or(0));
  if (depths.size() > 1 && is_free(task, "optical_depth"))
    throw InputError("free", "optical_depth",
                     "requires measurements of one thickness; for several, fit mean_free_path");
}

/// Checks the scene of a measurement, and marks the keys that this scene uses as read.
void read_scene(const Keys& keys, const SceneSpec& scene) {
  SceneSpec values;
  Keys own;
  add_keys(own, values);
  values = scene;
  own.read(values.dimension);
  const Scene made = make_scene(own, values);
  if (made.profile || made.index)
    throw InputError("layers, index_field: must not be given: fit requires homogeneous media");
  keys.merge_reads(own);
}

/// Returns the scenes of all measurements, with lights and views from the measurements and the free
/// parameters in the middle of their bounds.
std::vector<SceneSpec> middle_scenes(const mc::FitTask& task) {
  const Eigen::VectorXd middle = (lower_coordinates(task.free) + upper_coordinates(task.free)) / 2;
  std::vector<SceneSpec> scenes;
  for (const auto& measurement : task.measurements)
    for (const auto& curve : measurement.curves)
      scenes.push_back(mc::with_parameters(curve.scene, task.free, middle));
  return scenes;
}

void check_scenes(const Keys& keys, const mc::FitTask& task) {
  for (const SceneSpec& scene : middle_scenes(task)) read_scene(keys, scene);
}

/// Reads how many tilts and views a plan chooses.
void read_choice(const Keys& keys, const FitKeys& values, mc::PlanTask& task) {
  for (const std::string& text : keys.read(values.choose)) {
    const std::size_t equals = text.find('=');
    const std::string name(trimmed(text.substr(0, equals)));
    const bool tilts = name == "tilts";
    const auto& list = tilts ? task.scene.tilts : task.scene.view_angles;
    const auto most =
        equals == std::string::npos ? std::nullopt : read_number(text.substr(equals + 1));
    if (!(tilts || name == "view_angles") || !most || *most != std::floor(*most) ||
        !(*most >= 1 && *most <= static_cast<double>(list.size())))
      throw InputError("choose", text,
                       "must be tilts=N or view_angles=N, with N from 1 to the number given");
    (tilts ? task.most_tilts : task.most_views) = static_cast<std::size_t>(*most);
  }
}

mc::PlanTask plan_of(const Keys& keys, const FitKeys& values, const mc::MovingSpec& medium) {
  mc::PlanTask task;
  task.scene = medium;
  task.scene.covariance = "memory_effect";
  task.patterns = keys.read(values.patterns);
  task.free = mc::read_free_parameters(keys.required(values.free), medium);
  for (const auto& free : task.free)
    if (free.start.value_or(0) == 0)
      throw InputError("free", free.key, "must have a value other than 0 in the scene for a plan");
  if (std::ranges::find(task.scene.tilts, 0.0) != task.scene.tilts.end())
    throw InputError("tilts", 0,
                     "must not be 0 in a plan, which always has the field without tilt");
  read_scene(keys, task.scene);
  read_choice(keys, values, task);
  return task;
}

/// Throws InputError if keys give lights, views or tilts, because these are taken from the
/// measurements.
void refuse_views(const Keys& keys, const FitKeys& values) {
  for (const auto* list :
       {&values.medium.light_angles, &values.medium.view_angles, &values.medium.tilts})
    if (keys.given(*list))
      throw InputError(keys.name(*list), list->front(),
                       "is determined by the measurements; leave it out");
}

/// Whether transport can model the curve: the medium is a slab, and its scatterers do not flow.
bool is_still_slab(const mc::FitTask& task, const mc::Curve& curve) {
  const bool flows = !curve.scene.only_diffuses() || is_free(task, "velocity_x") ||
                     is_free(task, "velocity_z") || is_free(task, "shear");
  return curve.scene.domain == "slab" && !(curve.moving() && flows);
}

/// Reads the keys about motion of the scatterers and about detectors that the measurements require.
void read_motion(const Keys& keys, const FitKeys& values, const mc::FitTask& task) {
  const auto curves = mc::curves_of(task);
  const auto any = [&](mc::Observable observable, bool at_distances) {
    return std::ranges::any_of(curves, [&](const mc::Curve& curve) {
      return curve.observable == observable && curve.distances.has_value() == at_distances;
    });
  };
  using mc::Observable;
  const bool contrast =
      any(Observable::squared_contrast, false) || any(Observable::intensity_correlation, true);
  const mc::MovingSpec& medium = values.medium;
  const std::pair<const double&, bool> rows[] = {
      {medium.diffusion, task.moving()},
      {medium.velocity_x, task.moving()},
      {medium.velocity_z, task.moving()},
      {medium.shear, task.moving()},
      {medium.beta, contrast},
      {medium.detector_scale, any(Observable::reflectance, true)}};
  for (const auto& [member, of_use] : rows) {
    if (of_use)
      keys.read(member);
    else if (is_free(task, keys.name(member)))
      throw InputError("free", keys.name(member),
                       "cannot be determined: requires measurements with delays or exposures, or "
                       "reflectances at distances for detector_scale");
  }
}

/// Returns the settings of a model by Monte Carlo paths; nullopt if the model is computed by
/// transport.
std::optional<mc::PathSettings> paths_of(const Keys& keys, const FitKeys& values,
                                         const mc::FitTask& task, const Session& session) {
  const std::string method = keys.read(values.method);
  const bool slabs = std::ranges::all_of(task.measurements, [&](const mc::Measurement& one) {
    return std::ranges::all_of(one.curves,
                               [&](const mc::Curve& curve) { return is_still_slab(task, curve); });
  });
  if (method == "transport" || (method == "auto" && slabs)) return std::nullopt;
  if (task.at_distances())
    throw InputError("method", method,
                     "values at distances require method = transport and domain = slab, without "
                     "flow of the scatterers");
  return mc::PathSettings{session.seed(), session.threads(), keys.read(values.model_share),
                          keys.read(values.run.seconds), keys.read(values.trust_paths)};
}

mc::FitTask task_of(const Keys& keys, const FitKeys& values, const Session& session) {
  refuse_views(keys, values);
  mc::FitTask task;
  task.starts = static_cast<int>(keys.read(values.starts));
  task.most_iterations = static_cast<int>(keys.read(values.most_iterations));
  task.free = mc::read_free_parameters(keys.required(values.free), values.medium);
  for (const std::string& path : keys.required(values.measurements))
    task.measurements.push_back(read_measurement(path, keys, values.medium, values.detectors));
  read_motion(keys, values, task);
  task.paths = paths_of(keys, values, task, session);
  check_depths(task);
  check_scenes(keys, task);
  mc::check(task);
  return task;
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

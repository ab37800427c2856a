#include "apps/fit/fit_keys.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "apps/fit/measurement_file.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "mc/fit/medium_fit.h"
#include "mc/fit/task/fit_data.h"

namespace flatspeckle::apps {

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

namespace {

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

}  // namespace

std::vector<SceneSpec> middle_scenes(const mc::FitTask& task) {
  const Eigen::VectorXd middle = (lower_coordinates(task.free) + upper_coordinates(task.free)) / 2;
  std::vector<SceneSpec> scenes;
  for (const auto& measurement : task.measurements)
    for (const auto& curve : measurement.curves)
      scenes.push_back(mc::with_parameters(curve.scene, task.free, middle));
  return scenes;
}

namespace {

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

}  // namespace

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

namespace {

/// Throws InputError if keys give lights, views or tilts, because these are taken from the
/// measurements.
void refuse_views(const Keys& keys, const FitKeys& values) {
  for (const auto* list :
       {&values.medium.light_angles, &values.medium.view_angles, &values.medium.tilts})
    if (keys.given(*list))
      throw InputError(keys.name(*list), list->front(),
                       "is determined by the measurements; leave it out");
}

/// Throws InputError if all measurements are of light at distances, which is in space and enters
/// along z, but keys give directions or a dimension.
void refuse_directions(const Keys& keys, const FitKeys& values, const mc::FitTask& task) {
  const auto curves = mc::curves_of(task);
  if (!std::ranges::all_of(curves,
                           [](const mc::Curve& curve) { return curve.distances.has_value(); }))
    return;
  const mc::MovingSpec& medium = values.medium;
  const auto refuse = [&](const auto& member) {
    if (keys.given(member))
      throw InputError(keys.name(member) +
                       ": is not used for light at distances, which is in space and enters along "
                       "z; leave it out");
  };
  refuse(medium.dimension);
  refuse(medium.light_azimuths);
  refuse(medium.view_azimuths);
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

}  // namespace

mc::FitTask task_of(const Keys& keys, const FitKeys& values, const Session& session) {
  refuse_views(keys, values);
  mc::FitTask task;
  task.starts = static_cast<int>(keys.read(values.starts));
  task.most_iterations = static_cast<int>(keys.read(values.most_iterations));
  task.free = mc::read_free_parameters(keys.required(values.free), values.medium);
  for (const std::string& path : keys.required(values.measurements))
    task.measurements.push_back(read_measurement(path, keys, values.medium, values.detectors));
  refuse_directions(keys, values, task);
  read_motion(keys, values, task);
  task.paths = paths_of(keys, values, task, session);
  check_depths(task);
  check_scenes(keys, task);
  mc::check(task);
  return task;
}

}  // namespace flatspeckle::apps

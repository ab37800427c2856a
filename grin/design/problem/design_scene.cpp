#include "grin/design/problem/design_scene.h"

#include <cmath>

#include "core/keys/kinds.h"
#include "core/keys/number_text.h"
#include "core/numbers/address_space.h"

namespace flatspeckle::grin::design {

namespace {

constexpr std::int64_t most_nodes = 257;

/// Returns the number of nodes of each refinement level. Coarser levels are added before the first
/// one. With the default value of `nodes`, a box omits the first level, which has too few nodes,
/// and levels finer than the smallest feature are omitted.
std::vector<std::int64_t> levels_of(const Keys& keys, const FormValues& values) {
  auto nodes = keys.required(values.nodes);
  const bool is_default = nodes == FormValues().nodes;
  const std::int64_t fewest = values.design == "box" ? 9 : 5;
  if (is_default && values.design == "box") nodes.erase(nodes.begin());
  // A search that begins on a fine grid ends in a worse field
  while (nodes.front() % 2 == 1 && (nodes.front() + 1) / 2 >= fewest)
    nodes.insert(nodes.begin(), (nodes.front() + 1) / 2);
  const auto& feature = keys.read(values.smallest_feature);
  const auto spacing = [&](std::int64_t count) {
    return 2 * values.radius / static_cast<double>(count - 1);
  };
  while (feature && is_default && nodes.size() > 1 && spacing(nodes.back()) < *feature / 2)
    nodes.pop_back();
  if (feature && spacing(nodes.back()) < *feature / 2)
    throw InputError("nodes", nodes.back(),
                     "have a spacing of " + std::to_string(spacing(nodes.back())) +
                         ", less than half of smallest_feature; use fewer nodes");
  return nodes;
}

/// Returns the number of nodes of the first refinement level. Throws InputError unless each level
/// halves the node spacing of the previous one.
int first_nodes(const std::vector<std::int64_t>& nodes, int least) {
  if (nodes.front() < least)
    throw InputError("nodes", nodes.front(), "must be at least " + std::to_string(least));
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i] != 2 * nodes[i - 1] - 1)
      throw InputError("nodes", nodes[i],
                       "after " + std::to_string(nodes[i - 1]) + " must be " +
                           std::to_string(2 * nodes[i - 1] - 1) +
                           ": each level halves the spacing");
  return static_cast<int>(nodes.front());
}

/// Sets the bounds of the index and the start coefficients of a ball, a radial profile or a box,
/// relative to the index around the field. A box starts with that index at its faces.
void bound(const Keys& keys, const FormValues& values, FormStart& start) {
  const double host = start.host_index = keys.read(values.index_around);
  start.least_index = keys.read(values.least_index) / host;
  start.most_index = keys.read(values.most_index) / host;
  const double least = start.least_index - 1, most = start.most_index - 1;
  const double excess = keys.read(values.start_excess) / host;
  if (least > 0)
    throw InputError("least_index", values.least_index,
                     "must be at most " + number_text(host) + ", the index at the rim");
  if (most < 0)
    throw InputError("most_index", values.most_index,
                     "must be at least " + number_text(host) + ", the index at the rim");
  if (!(excess >= least && excess <= most))
    throw InputError("start_excess", values.start_excess,
                     "must lie in the range that least_index and most_index allow: " +
                         std::to_string(host * least) + " to " + std::to_string(host * most));
  start.coefficients.assign(shape_of(start.form).size(), excess);
  bounds_of(start.form, start.least_index, start.most_index).hold(start.coefficients);
  if (values.design != "box") return;
  if (const auto& gradient = keys.read(values.most_gradient))
    start.most_gradient = *gradient / host;
}

FormStart make_guide(const Keys& keys, const FormValues& values, double radius) {
  const int count = static_cast<int>(keys.read(values.coefficients));
  if (count != 0 && count < 4)
    throw InputError("coefficients", count,
                     "must be at least 4, or 0 to optimise the exponent alone");
  const GuideForm guide{{keys.read(values.index) - 1, keys.required(values.delta), radius}, count};
  const double start = count == 0 ? guide.core.exponent : 0;
  return {guide, 1, 1, std::vector<double>(guide.shape().size(), start), 0, 0};
}

}  // namespace

void add_keys(Keys& keys, FormValues& values) {
  keys.group("Designed field");
  keys.add("design", values.design,
           "ball: n = 1 + (1 - r^2/radius^2) s with a cubic spline s in space; radial: the same "
           "with a spline s of r; box: n = 1 + a cubic spline in a cube, 0 at its faces; guide: "
           "n^2 = n0^2 (1 - 2 delta p) with p = q + q (1 - q) s or p = a power of q, where q = "
           "(rho/radius)^2")
      .one_of({"ball", "radial", "box", "guide"});
  keys.add("radius", values.radius,
           "Radius of the ball (n = 1 at its surface) or of the guide's core, or half the side of "
           "the box; the field is centred at the origin")
      .positive()
      .unit("length");
  keys.add("nodes", values.nodes,
           "Nodes of the spline along each axis, for successive levels, each with half the spacing "
           "of the previous (for a box the default starts at 9 nodes)")
      .from(2, most_nodes)
      .only_of("ball, box");
  keys.add("coefficients", values.coefficients,
           "Number of coefficients of the spline that describes the index profile; for a guide, 0 "
           "optimises the exponent of a power law instead")
      .from(0, 1000)
      .only_of("radial, guide");
  keys.add("start_excess", values.start_excess,
           "Uniform start value of the spline: of s, with n = index_around + s inside a ball "
           "(C30), or of n - index_around in a box")
      .only_of("ball, radial, box");
  keys.add("least_index", values.least_index, "Lower bound of the index")
      .positive()
      .only_of("ball, radial, box");
  keys.add("most_index", values.most_index, "Upper bound of the index")
      .positive_to(100)
      .only_of("ball, radial, box");
  keys.add("index_around", values.index_around,
           "Index of the host around a ball or box; the index of the field equals it at the rim")
      .positive_to(100)
      .only_of("ball, radial, box");
  keys.add("smallest_feature", values.smallest_feature,
           "Smallest period of the index that can be made: nodes must be at least half of it apart")
      .positive()
      .unit("length")
      .only_of("ball, box");
  keys.add("most_gradient", values.most_gradient,
           "Upper bound of the magnitude of the gradient of the index")
      .positive()
      .unit("1/length")
      .only_of("box");
  keys.add("index", values.index, "Index n0 on the axis of the guide")
      .positive_to(100)
      .only_of("guide");
  keys.add("delta", values.delta,
           "Index contrast of the guide: n^2 = n0^2 (1 - 2 delta) at the radius")
      .positive_to(0.45)
      .only_of("guide");
}

FormStart make_form(const Keys& keys, const FormValues& values) {
  const double radius = keys.read(values.radius);
  const std::string& design = keys.read(values.design);
  if (design == "guide") return make_guide(keys, values, radius);
  FormStart start;
  if (design == "radial") {
    const int count = static_cast<int>(keys.read(values.coefficients));
    if (count < 4) throw InputError("coefficients", count, "must be at least 4");
    start.form = RadialForm{Vec3::Zero(), radius, 4, count};
    start.levels = count > 4 ? 2 : 1;
  } else {
    const auto nodes = levels_of(keys, values);
    if (design == "ball")
      start.form = BallForm{Vec3::Zero(), radius, first_nodes(nodes, 2)};
    else
      start.form = BoxForm{Vec3::Zero(), radius, first_nodes(nodes, 7)};
    start.levels = static_cast<int>(nodes.size());
    start.finest = static_cast<double>(nodes.back());
  }
  bound(keys, values, start);
  return start;
}

void add_keys(Keys& keys, TargetValues& values) {
  keys.group("Light and goal");
  keys.add("goal", values.goal,
           "Objective: parallel light meets in points (focus); rays of a fibre have equal delays "
           "(equal_path); beams form pictures (irradiance); rays leave in measured directions "
           "(deflections); light of point sources leaves parallel (collimation) or passes through "
           "an aperture (throughput)")
      .one_of(kind_words(values.kinds));
  each_kind(values.kinds, [&](auto& kind) {
    keys.group(std::string("Goal: ") + kind.word, kind.word);
    add_keys(keys, kind);
  });
}

std::unique_ptr<DesignTarget> make_target(const Keys& keys, const TargetValues& values,
                                          const FieldForm& form) {
  std::unique_ptr<DesignTarget> design_target;
  with_kind(values.kinds, keys.read(values.goal),
            [&](const auto& kind) { design_target = make_target(keys, kind, form); });
  return design_target;
}

namespace {

/// Throws InputError if the derivatives of all rays do not fit into memory. Each ray depends on
/// about as many coefficients as there are along its path in the finest grid.
void check_memory(const DesignScene& scene) {
  const double bytes = scene.design_target->rays() * (30 * scene.start.finest * 12 + 500);
  if (bytes > 0.8 * usable_memory())
    throw InputError("rays of this goal", scene.design_target->rays(),
                     "need " + std::to_string(bytes / 1e9) +
                         " GB of memory: reduce the number of rays or nodes");
}

/// Returns the length of an integration step and the largest number of steps. The default step in a
/// guide is a fraction of a quarter of the period of its rays.
RayWalk make_walk(const Keys& keys, const DesignValues& values, const FieldForm& form) {
  const double radius = values.form.radius;
  const std::optional<double> step = keys.read(values.step);
  if (const auto* guide = std::get_if<GuideForm>(&form)) {
    const double quarter =
        std::asin(1) * radius / ((1 + guide->core.axis_excess) * std::sqrt(2 * guide->core.delta));
    const double h = step.value_or(quarter / 24);
    if (h > quarter) throw InputError("step", h, "must be at most " + std::to_string(quarter));
    return {h, static_cast<long>(20 * quarter / h) + 20};
  }
  const double h = step.value_or(radius / 10);
  if (h > radius) throw InputError("step", h, "must be at most the radius");
  return {h, static_cast<long>(20 * radius / h) + 20};
}

void make_search(const Keys& keys, const DesignValues& values, DesignScene& scene) {
  keys.read(values.method);
  scene.roughness = keys.read(values.roughness);
  scene.iterations = static_cast<int>(keys.read(values.iterations));
  scene.tolerance = keys.read(values.tolerance);
  scene.target = keys.read(values.target).value_or(0);
  scene.has_noise = keys.read(values.noise).has_value();
  if (!scene.has_noise) return;
  if (scene.target > 0)
    throw InputError("target", scene.target,
                     "must not be given together with noise, which determines the target");
  scene.target = *values.noise * std::sqrt(scene.design_target->measurements());
  if (scene.roughness == 0) scene.roughness = 1e3;
}

}  // namespace

void add_keys(Keys& keys, DesignValues& values) {
  add_keys(keys, values.form);
  add_keys(keys, values.design_target);
  keys.group("Search");
  keys.add("method", values.method, "Search method: damped least squares")
      .one_of({"gauss_newton"})
      .gone("; lbfgs and adam are baselines of `bench error`");
  keys.add("step", values.step,
           "Step of ray integration, as a length at index 1 (default: 1/10 of the radius; for a "
           "guide 1/24 of a quarter of the rays' period)")
      .positive()
      .unit("length");
  keys.add("iterations", values.iterations,
           "Largest number of search steps over all levels; coarser levels use at most their share")
      .from(1, 1'000'000);
  keys.add(
          "tolerance", values.tolerance,
          "The search ends when two steps in a row on the last level reduce the residual by less "
          "than this, relative, or when the residual is below the integration error; 0: only after "
          "the iterations, at the target, or when no step reduces the residual")
      .from(0, 0.5);
  keys.add("target", values.target,
           "Root mean square residual of the rays at which the search ends; exit status 3 if not "
           "reached")
      .positive();
  keys.add("noise", values.noise,
           "Standard error of each measured number: the search starts smooth and lowers the weight "
           "of the roughness until the residuals equal this error (discrepancy principle)")
      .positive();
  keys.add("roughness", values.roughness,
           "Weight of the roughness (the squared third differences of the coefficients) relative "
           "to the residuals of the rays")
      .not_negative();
}

DesignScene make_design_scene(const Keys& keys, const DesignValues& values) {
  DesignScene scene;
  scene.start = make_form(keys, values.form);
  scene.design_target = make_target(keys, values.design_target, scene.start.form);
  scene.goal = values.design_target.goal;
  if (scene.goal == FocusValues::word)
    scene.focus =
        std::get<FocusValues>(values.design_target.kinds).focus.value_or(values.form.radius);
  scene.walk = make_walk(keys, values, scene.start.form);
  make_search(keys, values, scene);
  check_memory(scene);
  return scene;
}

DesignScene make_design_scene(const DesignValues& values) {
  return made_of(values, [](const Keys& keys, const DesignValues& all) {
    return make_design_scene(keys, all);
  });
}

}  // namespace flatspeckle::grin::design

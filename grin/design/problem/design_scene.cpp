#include "grin/design/problem/design_scene.h"

#include <cmath>

#include "core/keys/kinds.h"
#include "core/numbers/address_space.h"

namespace flatspeckle::grin::design {

namespace {

constexpr std::int64_t most_nodes = 257;

/// Of a box whose nodes are not given the first level, with too few, is left out.
std::vector<std::int64_t> levels_of(const Keys& keys, const FormValues& values) {
  auto nodes = keys.required(values.nodes);
  if (values.design == "box" && nodes == FormValues().nodes) nodes.erase(nodes.begin());
  return nodes;
}

/// Each level must halve the spacing.
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

/// Of a ball, a profile or a box; what a box starts from is 1 at its faces.
void bound(const Keys& keys, const FormValues& values, FormStart& start) {
  start.least_index = keys.read(values.least_index);
  start.most_index = keys.read(values.most_index);
  const double least = start.least_index - 1, most = start.most_index - 1;
  const double excess = keys.read(values.start_excess);
  if (least > 0) throw InputError("least_index", least + 1, "must be at most 1, as at the rim");
  if (most < 0) throw InputError("most_index", most + 1, "must be at least 1, as at the rim");
  if (!(excess >= least && excess <= most))
    throw InputError("start_excess", excess,
                     "crosses the bounds: least_index and most_index leave " +
                         std::to_string(least) + " to " + std::to_string(most));
  start.coefficients.assign(shape_of(start.form).size(), excess);
  bounds_of(start.form, start.least_index, start.most_index).hold(start.coefficients);
}

FormStart make_guide(const Keys& keys, const FormValues& values, double radius) {
  const int count = static_cast<int>(keys.read(values.coefficients));
  if (count != 0 && count < 4)
    throw InputError("coefficients", count, "must be at least 4, or 0: the exponent alone");
  const GuideForm guide{{keys.read(values.index) - 1, keys.required(values.delta), radius}, count};
  const double start = count == 0 ? guide.core.exponent : 0;
  return {guide, 1, 1, std::vector<double>(guide.shape().size(), start), 0, 0};
}

}  // namespace

void add_keys(Keys& keys, FormValues& values) {
  keys.group("Designed field");
  keys.add(
          "design", values.design,
          "n = 1 + (1 - r^2/R^2) s: s a cubic spline in space (ball), or of r (radial); n = 1 + a "
          "spline in a cube, 0 at its faces (box); n^2 = n0^2 (1 - 2 delta p), p = q + q (1 - q) s "
          "or a power of q = (rho/radius)^2 (guide)")
      .one_of({"ball", "radial", "box", "guide"});
  keys.add("radius", values.radius,
           "Of the ball, whose rim stays at n = 1, half the side of the box, of the guide's core; "
           "about the origin")
      .positive()
      .unit("length");
  keys.add("nodes", values.nodes,
           "Of the spline along each axis, of one level after another, each of half the spacing "
           "(box: "
           "from 9)")
      .from(2, most_nodes)
      .only_of("ball, box");
  keys.add("coefficients", values.coefficients,
           "Of s; of a guide 0: p is a power, whose exponent is sought")
      .from(0, 1000)
      .only_of("radial, guide");
  keys.add("start_excess", values.start_excess, "s at the start (box: n - 1), everywhere")
      .only_of("ball, radial, box");
  keys.add("least_index", values.least_index, "Bound of the index")
      .positive()
      .only_of("ball, radial, box");
  keys.add("most_index", values.most_index, "Bound of the index")
      .positive_to(100)
      .only_of("ball, radial, box");
  keys.add("index", values.index, "n0 on the axis").positive_to(100).only_of("guide");
  keys.add("delta", values.delta, "Of the guide: n^2 at the radius is n0^2 (1 - 2 delta)")
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

void add_keys(Keys& keys, AimValues& values) {
  keys.group("Light and goal");
  keys.add("goal", values.goal,
           "Parallel light meets in points (focus); rays of a fibre go at one speed (equal_path); "
           "beams show pictures (irradiance); rays leave as was measured (deflections); light of "
           "points leaves parallel (collimation), or passes through an aperture (throughput)")
      .one_of(kind_words(values.kinds));
  each_kind(values.kinds, [&](auto& kind) {
    keys.group(std::string("Goal: ") + kind.word, kind.word);
    add_keys(keys, kind);
  });
}

std::unique_ptr<Aim> make_aim(const Keys& keys, const AimValues& values, const FieldForm& form) {
  std::unique_ptr<Aim> aim;
  with_kind(values.kinds, keys.read(values.goal),
            [&](const auto& kind) { aim = make_aim(keys, kind, form); });
  return aim;
}

namespace {

/// Derivatives of rays, about what a way through the finest grid touches.
void check_memory(const DesignScene& scene) {
  const double bytes = scene.aim->rays() * (30 * scene.start.finest * 12 + 500);
  if (bytes > 0.8 * usable_memory())
    throw InputError("rays of this goal", scene.aim->rays(),
                     "need " + std::to_string(bytes / 1e9) + " GB of memory");
}

/// Steps and how many of them at most. A guide's are a part of a quarter of a turn.
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
  scene.target = keys.read(values.target).value_or(0);
  scene.has_noise = keys.read(values.noise).has_value();
  if (!scene.has_noise) return;
  if (scene.target > 0)
    throw InputError("target", scene.target, "must not be given beside noise, which sets it");
  scene.target = *values.noise * std::sqrt(scene.aim->readings());
  if (scene.roughness == 0) scene.roughness = 1e3;
}

}  // namespace

void add_keys(Keys& keys, DesignValues& values) {
  add_keys(keys, values.form);
  add_keys(keys, values.aim);
  keys.group("Search");
  keys.add("method", values.method, "Damped least squares")
      .one_of({"gauss_newton"})
      .gone("; lbfgs and adam are baselines of `bench error`");
  keys.add("step", values.step,
           "Of rays, length at index 1 (default: a tenth of the radius; in a guide a 24th of a "
           "quarter turn)")
      .positive()
      .unit("length");
  keys.add("iterations", values.iterations, "Steps of the search, of all levels at most")
      .from(1, 1'000'000);
  keys.add("target", values.target,
           "Root mean square of what rays miss by that is enough; not reached: exit status 3")
      .positive();
  keys.add("noise", values.noise,
           "Standard error of each measured number: the search starts smooth, and lowers "
           "the roughness' weight until what rays miss by is that (discrepancy principle)")
      .positive();
  keys.add("roughness", values.roughness,
           "Weight of third differences of the coefficients, relative to that of the rays")
      .not_negative();
}

DesignScene make_design_scene(const Keys& keys, const DesignValues& values) {
  DesignScene scene;
  scene.start = make_form(keys, values.form);
  scene.aim = make_aim(keys, values.aim, scene.start.form);
  scene.goal = values.aim.goal;
  if (scene.goal == FocusValues::word)
    scene.focus = std::get<FocusValues>(values.aim.kinds).focus.value_or(values.form.radius);
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

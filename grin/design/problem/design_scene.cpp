#include "grin/design/problem/design_scene.h"

#include <cmath>

#include "core/keys/kinds.h"
#include "core/numbers/address_space.h"

namespace flatspeckle::grin::design {

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

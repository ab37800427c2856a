#include "grin/design/design_scene.h"

#include "core/numbers/memory.h"

namespace flatspeckle::grin::design {

namespace {

constexpr std::int64_t most_nodes = 257;

/// The first level's nodes; each next level must halve the spacing.
BallForm ball_form(const Keys& keys, const DesignValues& values) {
  const auto& nodes = keys.required(values.nodes);
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i] != 2 * nodes[i - 1] - 1)
      throw InputError("nodes", nodes[i],
                       "after " + std::to_string(nodes[i - 1]) + " must be " +
                           std::to_string(2 * nodes[i - 1] - 1) +
                           ": each level halves the spacing");
  return {Vec3::Zero(), values.radius, static_cast<int>(nodes.front())};
}

Search search_of(const Keys& keys, const DesignValues& values) {
  const double least = keys.read(values.least_index) - 1, most = keys.read(values.most_index) - 1;
  const double start = keys.read(values.start_excess);
  if (least > 0) throw InputError("least_index", least + 1, "must be at most 1, as at the rim");
  if (most < 0) throw InputError("most_index", most + 1, "must be at least 1, as at the rim");
  if (!(start >= least && start <= most))
    throw InputError("start_excess", start,
                     "crosses the bounds: least_index and most_index leave " +
                         std::to_string(least) + " to " + std::to_string(most));
  return {.least = least, .most = most, .roughness = keys.read(values.roughness)};
}

/// Derivatives of rays, about what a way through the finest grid touches.
void check_memory(const DesignScene& scene, double finest) {
  const double rays = static_cast<double>(scene.light.directions) * scene.light.rays_each;
  const double touched = 30 * finest * 12, bytes = rays * (touched + 500);
  if (bytes > 0.8 * usable_memory())
    throw InputError("rays_per_direction", scene.light.rays_each,
                     "with " + std::to_string(scene.light.directions) + " directions needs " +
                         std::to_string(bytes / 1e9) + " GB of memory");
}

}  // namespace

void add_keys(Keys& keys, DesignValues& values) {
  keys.group("Designed field");
  keys.add("design", values.design,
           "n = 1 + (1 - r^2/R^2) s: s a cubic spline in space (ball), or of r^2 (radial)")
      .one_of({"ball", "radial"});
  keys.add("radius", values.radius,
           "Radius R of the ball, about the origin; its rim stays at n = 1")
      .positive()
      .unit("length");
  keys.add("nodes", values.nodes,
           "Of s along each axis, of one level after another, each of half the spacing")
      .from(2, most_nodes)
      .only_of("ball");
  keys.add("coefficients", values.coefficients, "Of s").from(4, 1000).only_of("radial");
  keys.add("start_excess", values.start_excess, "s at the start, everywhere");
  keys.add("least_index", values.least_index, "Bound of the index").positive();
  keys.add("most_index", values.most_index, "Bound of the index").positive_to(100);
  keys.group("Light and goal");
  keys.add("focus", values.focus,
           "Where parallel light is to meet, from the centre along its direction (default: radius)")
      .positive()
      .unit("length");
  keys.add("directions", values.directions, "Directions of light, evenly all around")
      .from(1, 100'000);
  keys.add("rays_per_direction", values.rays_per_direction, "Rays of each, evenly over the disk")
      .from(1, 1'000'000);
  keys.add("aperture", values.aperture, "Radius of that disk over the ball's").positive_to(1);
  keys.group("Search");
  keys.add("step", values.step, "Of rays, length at index 1 (default: a tenth of the radius)")
      .positive()
      .unit("length");
  keys.add("iterations", values.iterations, "Steps of the search, of all levels at most")
      .from(1, 100'000);
  keys.add("target", values.target,
           "Root mean square of what rays miss by that is enough; not reached: exit status 3")
      .positive()
      .unit("length");
  keys.add("roughness", values.roughness,
           "Weight of second differences of the coefficients, relative to that of the rays")
      .not_negative();
}

DesignScene make_design_scene(const Keys& keys, const DesignValues& values) {
  DesignScene scene;
  const double radius = keys.read(values.radius);
  double finest = 1;
  if (keys.read(values.design) == "ball") {
    scene.form = ball_form(keys, values);
    scene.levels = static_cast<int>(values.nodes.size());
    finest = static_cast<double>(values.nodes.back());
  } else {
    const int count = static_cast<int>(keys.read(values.coefficients));
    scene.form = RadialForm{Vec3::Zero(), radius, 4, count};
    scene.levels = count > 4 ? 2 : 1;
  }
  scene.search = search_of(keys, values);
  if (std::holds_alternative<RadialForm>(scene.form))
    scene.search.smooth_damping = 0;  // all is seen
  scene.start_excess = values.start_excess;
  scene.light = {{Vec3::Zero(), radius},
                 keys.read(values.focus).value_or(radius),
                 keys.read(values.aperture),
                 static_cast<int>(keys.read(values.directions)),
                 static_cast<int>(keys.read(values.rays_per_direction))};
  const double step = keys.read(values.step).value_or(radius / 10);
  if (step > radius) throw InputError("step", step, "must be at most the radius");
  scene.walk = {step, static_cast<long>(20 * radius / step) + 20};
  scene.iterations = static_cast<int>(keys.read(values.iterations));
  scene.target = keys.read(values.target).value_or(0);
  check_memory(scene, finest);
  return scene;
}

DesignScene make_design_scene(const DesignValues& values) {
  return made_of(values, [](const Keys& keys, const DesignValues& all) {
    return make_design_scene(keys, all);
  });
}

}  // namespace flatspeckle::grin::design

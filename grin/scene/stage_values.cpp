#include "grin/scene/stage_values.h"

#include <cmath>

namespace flatspeckle::grin {

namespace {

/// What one of the two keys says; nothing where neither is given.
std::optional<Surface> one_surface(const Keys& keys, const std::string& name,
                                   const std::vector<double>& box,
                                   const std::vector<double>& sphere) {
  std::vector<Surface> found;
  for (const Box& corners : boxes_of(keys, box)) found.push_back(corners);
  for (const Sphere& ball : spheres_of(keys, sphere)) found.push_back(ball);
  if (found.size() > 1)
    throw InputError(keys.name(box) + ", " + keys.name(sphere) + ": give one " + name);
  if (found.empty()) return std::nullopt;
  return found.front();
}

/// Distance from the z axis.
double reach_of(const Surface& surface) {
  const Box box = bounds(surface);
  const Vec3 far = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs());
  return std::hypot(far[0], far[1]);
}

void check_index(const SceneField& field, const Surface& region, const std::string& name) {
  constexpr int nodes = 33;
  const Box box = bounds(region);
  std::visit(
      [&](const auto& medium) {
        for (int node = 0; node < nodes * nodes * nodes; ++node) {
          const Vec3 share = Vec3(node / nodes / nodes, node / nodes % nodes, node % nodes);
          const Vec3 x = box.low + (box.high - box.low).cwiseProduct(share) / (nodes - 1);
          if (distance(region, x) > 0) continue;
          const double n = index(medium, x);
          if (!(n > 0 && std::isfinite(n)))
            throw InputError("index at " + listed(x), n, "must be positive in all of the " + name);
        }
      },
      field.field);
}

/// A grid beside the medium would leave it clear without a word.
void check_overlap(const ScatteringMedium& medium, const Surface& region, const std::string& key,
                   const std::string& name) {
  if (!medium.density) return;
  const Box grid{medium.density->grid().origin, medium.density->grid().end()};
  if (are_apart(grid, bounds(region)))
    throw InputError(key + ": the grid, from " + listed(grid.low) + " to " + listed(grid.high) +
                     ", is outside of the " + name);
}

ScatteringMedium medium_in(const Keys& keys, const MediumValues& values, const Surface& region,
                           const std::string& name) {
  const ScatteringMedium medium = make_medium(keys, values);
  check_overlap(medium, region, keys.name(values.density), name);
  return medium;
}

/// The body that the keys name, or the ball where a field ends at its rim.
std::optional<Surface> body_of(const SceneField& field, const Surface& boundary,
                               const std::optional<Surface>& body) {
  if (!field.rim || lies_in(body ? *body : boundary, *field.rim)) return body;
  if (body) throw InputError("body: must be inside of the rim of luneburg");
  if (std::holds_alternative<AnySum>(field.field))
    throw InputError("field: luneburg in a sum needs a stage or a body that is inside of its rim");
  return *field.rim;
}

void check_field(const SceneField& field, const Surface& region, const std::string& name) {
  if (field.grid && !lies_in(region, *field.grid))
    throw InputError("grid: ends inside of the " + name + ", and light needs a field in all of it");
  check_index(field, region, name);
}

}  // namespace

void add_keys(Keys& keys, StageValues& values) {
  constexpr const char *box = "two opposite corners, the low one first",
                       *sphere = "centre and radius";
  keys.group("Stage");
  keys.add("stage_box", values.stage_box,
           "x y z x y z of two corners: light leaves the scene through this box")
      .each_of(6, box);
  keys.add("stage_sphere", values.stage_sphere, "x y z radius: the same with a sphere")
      .each_of(4, sphere);
  add_keys(keys, values.medium, "");
  keys.group("Body in the stage");
  keys.add("body_box", values.body_box,
           "x y z x y z of two corners: the index field fills this body alone")
      .each_of(6, box);
  keys.add("body_sphere", values.body_sphere,
           "x y z radius: the same with a sphere; luneburg in a larger stage needs none")
      .each_of(4, sphere);
  keys.group("Body in the stage", "a body (body_box, body_sphere)");
  keys.add("index_around", values.index_around, "Index around the body").positive();
  add_keys(keys, values.body_medium, "body_");
  add_keys(keys, values.plain_bodies);
}

FilledStage make_stage(const Keys& keys, const StageValues& values, const IndexFieldValues& field,
                       bool any_phase, const std::optional<double>& length_unit) {
  const auto boundary = one_surface(keys, "stage", values.stage_box, values.stage_sphere);
  if (!boundary)
    throw InputError(
        "stage is not given: light that leaves the index field needs a boundary (stage_box or "
        "stage_sphere)");
  const auto given_body = one_surface(keys, "body", values.body_box, values.body_sphere);
  const double reach = reach_of(given_body ? *given_body : *boundary);
  FilledStage filled{
      {.boundary = *boundary},
      make_scene_field(keys, field,
                       {.reach = reach, .any_phase = any_phase, .length_unit = length_unit})};
  Stage& stage = filled.stage;
  if (const auto body = body_of(filled.field, *boundary, given_body)) {
    stage.bodies.push_back({*body, medium_in(keys, values.body_medium, *body, "body")});
    stage.excess_around = keys.read(values.index_around) - 1;
  }
  for (Body& body : make_plain_bodies(keys, values.plain_bodies, *boundary))
    stage.bodies.push_back(std::move(body));
  sort_by_size(stage.bodies);
  stage.medium = medium_in(keys, values.medium, *boundary, "stage");
  check(stage);
  const Part filled_part = stage.field_part();
  check_field(filled.field, stage.surface(filled_part), filled_part == around ? "stage" : "body");
  return filled;
}

}  // namespace flatspeckle::grin

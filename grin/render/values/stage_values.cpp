#include "grin/render/values/stage_values.h"

#include <cmath>

namespace flatspeckle::grin {

namespace {

std::optional<Surface> given_boundary(const Keys& keys, const StageValues& values) {
  std::vector<Surface> given;
  for (const Box& box : boxes_of(keys, values.stage_box)) given.push_back(box);
  for (const Sphere& sphere : spheres_of(keys, values.stage_sphere)) given.push_back(sphere);
  return one_surface("stage", "stage_box, stage_sphere", given);
}

/// Distance from the z axis.
double reach_of(const Surface& surface) {
  const Box box = bounds(surface);
  const Vec3 far = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs());
  return std::hypot(far[0], far[1]);
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
  if (body) check_rim(field, *body);
  if (body || !field.rim || lies_in(boundary, *field.rim)) return body;
  if (std::holds_alternative<AnySum>(field.field))
    throw InputError("field: luneburg in a sum needs a stage or a body that is inside of its rim");
  return *field.rim;
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
  add_body_keys(keys, values);
  keys.group("Body in the stage", std::string("a body (") + body_key_names + ")");
  add_index_around(keys, values);
  add_keys(keys, values.body_medium, "body_");
  add_keys(keys, values.plain_bodies);
}

FilledStage make_stage(const Keys& keys, const StageValues& values, const IndexFieldValues& field,
                       bool any_phase, const std::optional<double>& length_unit) {
  const auto boundary = given_boundary(keys, values);
  if (!boundary)
    throw InputError(
        "stage is not given: light that leaves the index field needs a boundary (stage_box or "
        "stage_sphere)");
  const auto given = given_body(keys, values, &*boundary);
  const double reach = reach_of(given ? *given : *boundary);
  const FieldUse use{.reach = reach, .any_phase = any_phase, .length_unit = length_unit};
  FilledStage filled{
      .stage = {.boundary = *boundary}, .field = make_scene_field(keys, field, use), .use = use};
  Stage& stage = filled.stage;
  if (const auto body = body_of(filled.field, *boundary, given)) {
    stage.bodies.push_back({*body, medium_in(keys, values.body_medium, *body, "body")});
    stage.excess_around = keys.read(values.index_around) - 1;
  }
  for (Body& body : make_plain_bodies(keys, values.plain_bodies)) {
    check_within(body, *boundary, "stage");
    stage.bodies.push_back(std::move(body));
  }
  sort_by_size(stage.bodies);
  stage.medium = medium_in(keys, values.medium, *boundary, "stage");
  check(stage);
  const Part filled_part = stage.field_part();
  filled.index = check_field(filled.field, stage.surface(filled_part),
                             filled_part == around ? "stage" : "body");
  return filled;
}

}  // namespace flatspeckle::grin

#include "grin/trace/ray_bodies.h"

#include "grin/render/stage/regions.h"

namespace flatspeckle::grin {

namespace {

Box hull_of(const std::vector<Body>& bodies) {
  Box hull = bounds(bodies.front().surface);
  for (const Body& body : bodies) {
    const Box box = bounds(body.surface);
    hull = {hull.low.cwiseMin(box.low), hull.high.cwiseMax(box.high)};
  }
  return hull;
}

void fill(const Surface& body, SceneField& field) {
  check_rim(field, body);
  check_field(field, body, "body");
  field.rim.reset();
  field.grid.reset();
}

}  // namespace

void add_keys(Keys& keys, RayBodyValues& values) {
  keys.group("Body that rays pass");
  add_body_keys(keys, values);
  keys.group("Body that rays pass", std::string("a body (") + body_key_names + ")");
  add_index_around(keys, values);
  add_keys(keys, values.plain_bodies);
}

Stage make_ray_stage(const Keys& keys, const RayBodyValues& values, SceneField& field) {
  Stage stage;
  if (const auto body = given_body(keys, values)) {
    fill(*body, field);
    stage.bodies.push_back({*body});
    stage.excess_around = keys.read(values.index_around) - 1;
  }
  for (Body& body : make_plain_bodies(keys, values.plain_bodies)) {
    if (field.grid) check_within(body, *field.grid, "grid");
    stage.bodies.push_back(std::move(body));
  }
  if (stage.bodies.empty()) return stage;
  field.symmetry = Symmetry::none;
  sort_by_size(stage.bodies);
  stage.boundary = hull_of(stage.bodies);
  return stage;
}

double index_at(const SceneField& field, const Stage& stage, const Vec3& x) {
  const Part part = Regions(stage).at(x);
  return part == stage.field_part() ? index_at(field, x) : 1 + stage.excess_in(part);
}

}  // namespace flatspeckle::grin

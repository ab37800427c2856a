#include "apps/stage_options.h"

#include <cmath>

#include "apps/key_values.h"
#include "core/error.h"

namespace flatspeckle::apps {

namespace {

using grin::Vec3;

/// What one of the two keys says; nothing where neither is given.
std::optional<grin::Surface> one_surface(const std::string& name, const std::vector<double>& box,
                                         const std::vector<double>& sphere) {
  const std::string box_key = name + "_box", sphere_key = name + "_sphere";
  std::vector<grin::Surface> found;
  for (const auto& corners : boxes_of(box_key, box)) found.push_back(corners);
  for (const auto& ball : spheres_of(sphere_key, sphere)) found.push_back(ball);
  if (found.size() > 1) throw InputError(box_key + ", " + sphere_key + ": give one " + name);
  if (found.empty()) return std::nullopt;
  return found.front();
}

/// How far the farthest point of one surface is outside of another; both are spheres or boxes.
double overhang(const grin::Surface& inner, const grin::Surface& outer) {
  if (const auto* sphere = std::get_if<grin::Sphere>(&inner))
    return distance(outer, sphere->centre) + sphere->radius;
  const grin::Box box = std::get<grin::Box>(inner);
  double most = -1e300;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = corner >> a & 1 ? box.high[a] : box.low[a];
    most = std::max(most, distance(outer, x));
  }
  return most;
}

bool fits(const grin::Surface& inner, const grin::Surface& outer) {
  const grin::Box box = bounds(outer);
  return overhang(inner, outer) <= 1e-9 * (box.high - box.low).norm();
}

/// Distance from the z axis.
double reach_of(const grin::Surface& surface) {
  const grin::Box box = bounds(surface);
  const Vec3 far = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs());
  return std::hypot(far[0], far[1]);
}

void check_index(const SceneField& field, const grin::Surface& region, const std::string& name) {
  constexpr int nodes = 33;
  const grin::Box box = bounds(region);
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
void check_overlap(const grin::ScatteringMedium& medium, const grin::Surface& region,
                   const std::string& key, const std::string& name) {
  if (!medium.density) return;
  const Vec3 low = medium.density->grid().origin, high = medium.density->grid().end();
  const grin::Box box = bounds(region);
  if ((low.array() >= box.high.array()).any() || (high.array() <= box.low.array()).any())
    throw InputError(key + ": the grid, from " + listed(low) + " to " + listed(high) +
                     ", is outside of the " + name);
}

class StageMaker {
 public:
  StageMaker(const Subcommand& command, const StageSpec& spec) : command_(command), spec_(spec) {
    const auto boundary = one_surface("stage", spec.stage_box, spec.stage_sphere);
    if (!boundary)
      throw InputError(
          "stage is not given: light that leaves the index field needs a boundary (stage_box or "
          "stage_sphere)");
    stage_.boundary = *boundary;
    body_ = one_surface("body", spec.body_box, spec.body_sphere);
    given_body_ = body_.has_value();
  }

  FilledStage make(const IndexFieldSpec& field) {
    SceneField filled = make_index_field(command_, field, reach_of(region()));
    settle_rim(filled);
    if (body_ && !fits(*body_, stage_.boundary))
      throw InputError(given_body_ ? "body: must be inside of the stage"
                                   : "luneburg: its ball must be inside of the stage, or the stage "
                                     "inside of it");
    if (filled.grid && !fits(region(), *filled.grid))
      throw InputError("grid: ends inside of the " + name() +
                       ", and light needs a field in all of it");
    check_index(filled, region(), name());
    stage_.medium = make_space_medium(command_, spec_.medium, "");
    check_overlap(stage_.medium, stage_.boundary, "density", "stage");
    add_body();
    return {stage_, filled};
  }

 private:
  const grin::Surface& region() const { return body_ ? *body_ : stage_.boundary; }
  std::string name() const { return body_ ? "body" : "stage"; }

  /// The field of a ball ends at its rim.
  void settle_rim(const SceneField& field) {
    if (!field.rim || fits(region(), *field.rim)) return;
    if (body_) throw InputError("body: must be inside of the rim of luneburg");
    if (!std::holds_alternative<grin::Luneburg>(field.field))
      throw InputError(
          "field: luneburg in a sum needs a stage or a body that is inside of its rim");
    body_ = *field.rim;
  }

  void add_body() {
    if (!body_) {
      const std::string key = first_medium_key(command_, "body_");
      if (!key.empty()) throw InputError(key + ": there is no body (body_sphere or body_box)");
      if (spec_.index_around)
        throw InputError("index_around: there is no body (body_sphere or body_box)");
      return;
    }
    stage_.body = grin::Body{*body_, make_space_medium(command_, spec_.body_medium, "body_")};
    check_overlap(stage_.body->medium, *body_, "body_density", "body");
    stage_.excess_around = positive("index_around", spec_.index_around.value_or(1)) - 1;
  }

  const Subcommand& command_;
  const StageSpec& spec_;
  grin::Stage stage_;
  std::optional<grin::Surface> body_;
  bool given_body_ = false;  // else the ball of luneburg
};

}  // namespace

grin::Box bounds(const grin::Surface& surface) {
  if (const auto* sphere = std::get_if<grin::Sphere>(&surface)) {
    const Vec3 half = Vec3::Constant(sphere->radius);
    return {sphere->centre - half, sphere->centre + half};
  }
  return std::get<grin::Box>(surface);
}

void add_stage_options(Options& options, StageSpec& spec) {
  options.add("--stage_box", spec.stage_box,
              "x y z x y z of two corners: light leaves the scene through this box");
  options.add("--stage_sphere", spec.stage_sphere, "x y z radius: the same with a sphere");
  add_space_medium_options(options, spec.medium, "", "the stage around the body");
  options.add("--body_box", spec.body_box,
              "x y z x y z of two corners: the index field fills this body alone");
  options.add("--body_sphere", spec.body_sphere,
              "x y z radius: the same with a sphere; luneburg in a larger stage needs none");
  options.add("--index_around", spec.index_around, "Index around the body (default 1)");
  add_space_medium_options(options, spec.body_medium, "body_", "the body");
}

FilledStage make_stage(const Subcommand& command, const StageSpec& spec,
                       const IndexFieldSpec& field) {
  return StageMaker(command, spec).make(field);
}

}  // namespace flatspeckle::apps

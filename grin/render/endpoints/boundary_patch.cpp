#include "grin/render/endpoints/boundary_patch.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

/// Largest distance of a given centre from the surface, in units of the size of the sphere or box.
constexpr double nearness = 1e-6;

[[noreturn]] void refuse_boundary(const char* key) {
  throw InputError(std::string(key) + ": requires a sphere or a box as boundary of the stage");
}

BoundaryPoint on_sphere(const Sphere& sphere, const Vec3& x) {
  const Vec3 outward = sphere.normal(x);
  return {sphere.centre + sphere.radius * outward, -outward};
}

BoundaryPoint on_box(const Box& box, const Vec3& x) {
  const Vec3 inward = -box.normal(x);
  int axis;
  inward.cwiseAbs().maxCoeff(&axis);
  BoundaryPoint point{x.cwiseMax(box.low).cwiseMin(box.high), inward};
  point.x[axis] = inward[axis] > 0 ? box.low[axis] : box.high[axis];
  return point;
}

/// Returns the distance from a point on a face of the box to the nearest edge of that face.
double distance_to_edge(const Box& box, const BoundaryPoint& at) {
  double limit = INFINITY;
  for (int a = 0; a < 3; ++a)
    if (at.inward[a] == 0) limit = std::min({limit, at.x[a] - box.low[a], box.high[a] - at.x[a]});
  return limit;
}

}  // namespace

std::optional<BoundaryPoint> boundary_point(const Surface& boundary, const Vec3& x) {
  const auto near = [&](double size) { return std::abs(distance(boundary, x)) <= nearness * size; };
  if (const auto* sphere = std::get_if<Sphere>(&boundary)) {
    if (near(sphere->radius)) return on_sphere(*sphere, x);
  } else if (const auto* box = std::get_if<Box>(&boundary)) {
    if (near((box->high - box->low).norm())) return on_box(*box, x);
  }
  return std::nullopt;
}

BoundaryPatch::BoundaryPatch(const Surface& boundary, const char* key) {
  if (const auto* sphere = std::get_if<Sphere>(&boundary)) {
    const Vec3 pole = sphere->centre + sphere->radius * Vec3::UnitZ();
    shape_ = Cap{*sphere, pole, Vec3::UnitZ(), 2 * sphere->radius};
    area_ = 4 * pi * sphere->radius * sphere->radius;
  } else if (const auto* box = std::get_if<Box>(&boundary)) {
    const Vec3 size = box->high - box->low;
    const Vec3 pair(size.y() * size.z(), size.z() * size.x(), size.x() * size.y());
    area_ = 2 * pair.sum();
    const Vec3 share = pair / pair.sum();
    shape_ = Faces{*box, {share.x(), share.y(), share.z()}};
  } else {
    refuse_boundary(key);
  }
}

BoundaryPatch::BoundaryPatch(const Surface& boundary, const Vec3& centre, double radius,
                             const char* centre_key, const char* radius_key)
    : area_(pi * radius * radius) {
  const auto* sphere = std::get_if<Sphere>(&boundary);
  const auto* box = std::get_if<Box>(&boundary);
  if (!sphere && !box) refuse_boundary(centre_key);
  const auto at = boundary_point(boundary, centre);
  if (!at) throw InputError(centre_key, listed(centre), "must be on the boundary of the stage");
  const double limit = sphere ? 2 * sphere->radius : distance_to_edge(*box, *at);
  if (!(radius > 0 && radius <= limit * (1 + nearness)))
    throw InputError(radius_key, radius,
                     sphere ? "must be positive and at most the diameter of the boundary"
                            : "must be positive and within one face of the boundary");
  if (sphere)
    shape_ = Cap{*sphere, at->x, -at->inward, radius};
  else
    shape_ = FlatDisk(at->x, at->inward, radius);
}

BoundaryPoint BoundaryPatch::sample(const Cap& cap, RandomStream& random) {
  // the area of a cap is proportional to the square of the chord from its centre to its rim
  const double ratio = cap.chord / cap.sphere.radius;
  const Vec3 outward = random_turn(cap.axis, ratio * ratio * random.uniform() / 2, random);
  return {cap.sphere.centre + cap.sphere.radius * outward, -outward};
}

BoundaryPoint BoundaryPatch::sample(const FlatDisk& disk, RandomStream& random) {
  return {disk.sample(random), disk.normal()};
}

BoundaryPoint BoundaryPatch::sample(const Faces& faces, RandomStream& random) {
  const double u = random.uniform();
  const auto& probability = faces.pair_probability;
  const int axis = u < probability[0] ? 0 : u < probability[0] + probability[1] ? 1 : 2;
  const bool high = random.uniform() < 0.5;
  Vec3 x;
  for (int a = 0; a < 3; ++a)
    if (a != axis)
      x[a] = faces.box.low[a] + (faces.box.high[a] - faces.box.low[a]) * random.uniform();
  x[axis] = high ? faces.box.high[axis] : faces.box.low[axis];
  return {x, Vec3::Unit(axis) * (high ? -1 : 1)};
}

BoundaryPoint BoundaryPatch::sample(RandomStream& random) const {
  return std::visit([&](const auto& shape) { return sample(shape, random); }, shape_);
}

BoundaryPoint BoundaryPatch::polar(double r, double azimuth) const {
  if (const auto* disk = std::get_if<FlatDisk>(&shape_))
    return {disk->polar(r, azimuth), disk->normal()};
  const Cap& cap = std::get<Cap>(shape_);
  const double ratio = r / cap.sphere.radius;
  const Vec3 outward = direction_about(cap.axis, 1 - ratio * ratio / 2, azimuth);
  return {cap.sphere.centre + cap.sphere.radius * outward, -outward};
}

bool BoundaryPatch::contains(const Vec3& x) const {
  if (const auto* cap = std::get_if<Cap>(&shape_))
    return cap->chord >= 2 * cap->sphere.radius || (x - cap->centre).norm() <= cap->chord;
  if (const auto* disk = std::get_if<FlatDisk>(&shape_)) return disk->reaches(x);
  return true;
}

Vec3 BoundaryPatch::inward(const Vec3& x) const {
  if (const auto* cap = std::get_if<Cap>(&shape_)) return -cap->sphere.normal(x);
  if (const auto* disk = std::get_if<FlatDisk>(&shape_)) return disk->normal();
  return -std::get<Faces>(shape_).box.normal(x);
}

}  // namespace flatspeckle::grin

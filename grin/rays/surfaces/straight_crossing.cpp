#include "grin/rays/surfaces/straight_crossing.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace flatspeckle::grin {

namespace {

/// The part of a line that is within an object, between two distances along the line.
struct Interval {
  double from, to;

  bool is_empty() const { return !(from < to); }
  Interval within(const Interval& other) const {
    return {std::max(from, other.from), std::min(to, other.to)};
  }
};
constexpr Interval whole{-no_crossing, no_crossing}, none{no_crossing, -no_crossing};

/// Returns the interval of t where a t^2 + 2 b t + c < 0, for a > 0. under: the discriminant b^2 -
/// a c.
Interval between_roots(double a, double b, double c, double under) {
  if (!(under > 0)) return none;
  const double far = -(b + std::copysign(std::sqrt(under), b));
  return {std::min(far / a, c / far), std::max(far / a, c / far)};
}
Interval interval_in_cylinder(const Lens& lens, const Vec3& x, const Vec3& d) {
  const Vec3 from = lens.across(x), along(d[0], d[1], 0);
  const double a = along.squaredNorm(), b = from.dot(along), c = lens.barrel_power(x);
  if (a == 0) return c < 0 ? whole : none;
  return between_roots(a, b, c, b * b - a * c);
}
Interval interval_inside(const Plane& plane, const Vec3& x, const Vec3& d) {
  const double speed = plane.outwards.dot(d), distance = plane.distance(x);
  if (speed == 0) return distance < 0 ? whole : none;
  const double at = -distance / speed;
  return speed > 0 ? Interval{-no_crossing, at} : Interval{at, no_crossing};
}

/// Intersection of a line with the sphere of which a curved face of a lens is a part. The argument
/// of the square root is computed from the point of the line closest to the vertex, which avoids
/// cancellation at a large radius.
struct LineThroughFace {
  Interval within;  ///< part of the line within the sphere
  double away;      ///< positive if the line goes away from the centre of the sphere

  LineThroughFace(const LensFace& face, const Vec3& x, const Vec3& d) {
    const Vec3 p = x - face.vertex, closest = p - p.dot(d) * d;
    const double bend = std::abs(face.curvature), side = std::copysign(1.0, face.curvature);
    const double under =
        d[2] * d[2] + face.curvature * (2 * closest[2] - face.curvature * closest.squaredNorm());
    away = bend * p.dot(d) - side * d[2];
    within = between_roots(bend, away, bend * p.squaredNorm() - 2 * side * p[2], under);
  }
};

/// Whether the point where a line meets the sphere of a convex face lies on the face itself, within
/// the accuracy of this point.
bool is_on_cap(const LensFace& face, const Vec3& x, const Vec3& d, double ray_length) {
  const double beyond = face.outwards * (x[2] + ray_length * d[2] - face.edge);
  return beyond >= -crossing_accuracy(std::max(std::abs(face.edge), std::abs(x[2])));
}

/// Returns the distance at which a line from inside the lens leaves the lens through a face.
double exit_distance(const LensFace& face, const Vec3& x, const Vec3& d) {
  if (face.is_plane()) return exit_distance(face.edge_plane(), x, d);
  const LineThroughFace line(face, x, d);
  if (line.within.is_empty()) return no_crossing;
  const double ray_length = face.is_concave() ? line.within.from : line.within.to;
  const bool leaves = face.is_concave() ? line.away < 0 : is_on_cap(face, x, d, ray_length);
  return leaves ? std::max(0.0, ray_length) : no_crossing;
}

/// Returns the part of a line that is inside a convex face of a lens or, for another face, inside
/// its edge plane. The result is valid only within the cylinder of the lens.
Interval before(const LensFace& face, const Vec3& x, const Vec3& d) {
  Interval inside = interval_inside(face.edge_plane(), x, d);
  if (face.is_plane() || face.is_concave()) return inside;
  const Interval within = LineThroughFace(face, x, d).within;
  if (within.is_empty()) return inside;
  if (is_on_cap(face, x, d, within.from)) inside.from = within.from;
  if (is_on_cap(face, x, d, within.to)) inside.to = within.to;
  return inside;
}

}  // namespace

double exit_distance(const Lens& lens, const Vec3& x, const Vec3& d) {
  double ray_length = std::max(0.0, interval_in_cylinder(lens, x, d).to);
  for (const LensFace& face : lens.faces())
    ray_length = std::min(ray_length, exit_distance(face, x, d));
  return ray_length;
}

/// Returns the distance at which a line enters the lens through a face or the cylinder, or after it
/// has crossed the hollow of a concave face. A point that is inside the lens by more than rounding
/// counts as leaving the lens: its line enters only after it has left.
double entry_distance(const Lens& lens, const Vec3& x, const Vec3& d) {
  Interval within = interval_in_cylinder(lens, x, d);
  std::array<Interval, 2> concavities{none, none};
  for (std::size_t i = 0; i < concavities.size(); ++i) {
    const LensFace& face = lens.faces()[i];
    within = within.within(before(face, x, d));
    if (face.is_concave()) concavities[i] = LineThroughFace(face, x, d).within;
  }
  const auto [low, high] = lens.bounds();
  const double rounding =
      crossing_accuracy(x) + crossing_accuracy(std::max(std::abs(low[2]), std::abs(high[2])));
  const auto is_entry = [&](double ray_length) {
    return ray_length > -rounding && ray_length >= within.from &&
           ray_length < within.to - rounding &&
           std::ranges::none_of(concavities, [&](const Interval& concavity) {
             return concavity.from - rounding <= ray_length && ray_length < concavity.to;
           });
  };
  double first = no_crossing;
  for (const double ray_length : {within.from, concavities[0].to, concavities[1].to})
    if (is_entry(ray_length)) first = std::min(first, std::max(0.0, ray_length));
  return first;
}

}  // namespace flatspeckle::grin

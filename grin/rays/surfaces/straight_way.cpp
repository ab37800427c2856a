#include "grin/rays/surfaces/straight_way.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace flatspeckle::grin {

namespace {

/// Of a line: where it is within something.
struct Stretch {
  double from, to;

  bool is_empty() const { return !(from < to); }
  Stretch within(const Stretch& other) const {
    return {std::max(from, other.from), std::min(to, other.to)};
  }
};
constexpr Stretch whole{-no_way, no_way}, none{no_way, -no_way};

/// Where t^2 a + 2 t b + c < 0, a > 0; under: b^2 - a c.
Stretch between_roots(double a, double b, double c, double under) {
  if (!(under > 0)) return none;
  const double far = -(b + std::copysign(std::sqrt(under), b));
  return {std::min(far / a, c / far), std::max(far / a, c / far)};
}
Stretch stretch_of_cylinder(const Lens& lens, const Vec3& x, const Vec3& d) {
  const Vec3 from = lens.across(x), along(d[0], d[1], 0);
  const double a = along.squaredNorm(), b = from.dot(along), c = lens.barrel_power(x);
  if (a == 0) return c < 0 ? whole : none;
  return between_roots(a, b, c, b * b - a * c);
}
Stretch stretch(const Plane& plane, const Vec3& x, const Vec3& d) {
  const double speed = plane.outwards.dot(d), distance = plane.distance(x);
  if (speed == 0) return distance < 0 ? whole : none;
  const double at = -distance / speed;
  return speed > 0 ? Stretch{-no_way, at} : Stretch{at, no_way};
}

/// A line and the sphere of a curved face, the square root's argument from the point of the line
/// that is closest to the vertex: at a large radius neither cancels.
struct LineThroughFace {
  Stretch within;  ///< the sphere
  double away;     ///< more than 0 where the line goes away from the centre

  LineThroughFace(const LensFace& face, const Vec3& x, const Vec3& d) {
    const Vec3 p = x - face.vertex, closest = p - p.dot(d) * d;
    const double bend = std::abs(face.curvature), side = std::copysign(1.0, face.curvature);
    const double under =
        d[2] * d[2] + face.curvature * (2 * closest[2] - face.curvature * closest.squaredNorm());
    away = bend * p.dot(d) - side * d[2];
    within = between_roots(bend, away, bend * p.squaredNorm() - 2 * side * p[2], under);
  }
};

/// Whether a line meets the sphere of a convex face on its cap, to the accuracy of that place.
bool is_on_cap(const LensFace& face, const Vec3& x, const Vec3& d, double way) {
  const double beyond = face.outwards * (x[2] + way * d[2] - face.edge);
  return beyond >= -crossing_accuracy(std::max(std::abs(face.edge), std::abs(x[2])));
}

/// To where a line from inside of the lens leaves it through a face.
double way_out(const LensFace& face, const Vec3& x, const Vec3& d) {
  if (face.is_plane()) return way_out(face.edge_plane(), x, d);
  const LineThroughFace line(face, x, d);
  if (line.within.is_empty()) return no_way;
  const double way = face.is_concave() ? line.within.from : line.within.to;
  const bool leaves = face.is_concave() ? line.away < 0 : is_on_cap(face, x, d, way);
  return leaves ? std::max(0.0, way) : no_way;
}

/// Of a line within the lens's cylinder, inside of a convex face or of the plane of another's edge.
Stretch before(const LensFace& face, const Vec3& x, const Vec3& d) {
  Stretch inside = stretch(face.edge_plane(), x, d);
  if (face.is_plane() || face.is_concave()) return inside;
  const Stretch within = LineThroughFace(face, x, d).within;
  if (within.is_empty()) return inside;
  if (is_on_cap(face, x, d, within.from)) inside.from = within.from;
  if (is_on_cap(face, x, d, within.to)) inside.to = within.to;
  return inside;
}

}  // namespace

double way_out(const Lens& lens, const Vec3& x, const Vec3& d) {
  double way = std::max(0.0, stretch_of_cylinder(lens, x, d).to);
  for (const LensFace& face : lens.faces()) way = std::min(way, way_out(face, x, d));
  return way;
}

/// At the front or the cylinder, or out of a hollow. What is within already, to more than rounding,
/// is on its way out.
double way_in(const Lens& lens, const Vec3& x, const Vec3& d) {
  Stretch within = stretch_of_cylinder(lens, x, d);
  std::array<Stretch, 2> hollows{none, none};
  for (std::size_t i = 0; i < hollows.size(); ++i) {
    const LensFace& face = lens.faces()[i];
    within = within.within(before(face, x, d));
    if (face.is_concave()) hollows[i] = LineThroughFace(face, x, d).within;
  }
  const auto [low, high] = lens.bounds();
  const double rounding =
      crossing_accuracy(x) + crossing_accuracy(std::max(std::abs(low[2]), std::abs(high[2])));
  const auto is_way_in = [&](double way) {
    return way > -rounding && way >= within.from && way < within.to - rounding &&
           std::ranges::none_of(hollows, [&](const Stretch& hollow) {
             return hollow.from - rounding <= way && way < hollow.to;
           });
  };
  double first = no_way;
  for (const double way : {within.from, hollows[0].to, hollows[1].to})
    if (is_way_in(way)) first = std::min(first, std::max(0.0, way));
  return first;
}

}  // namespace flatspeckle::grin

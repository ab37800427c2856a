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

/// Where t^2 a + 2 t b + c < 0.
Stretch between_roots(double a, double b, double c) {
  if (a == 0) return c < 0 ? whole : none;
  const double under = b * b - a * c;
  if (under <= 0) return none;
  const double far = -(b + std::copysign(std::sqrt(under), b));
  return {std::min(far / a, c / far), std::max(far / a, c / far)};
}
Stretch stretch(const Sphere& sphere, const Vec3& x, const Vec3& d) {
  const Vec3 from = x - sphere.centre;
  return between_roots(1, from.dot(d), from.squaredNorm() - sphere.radius * sphere.radius);
}
Stretch stretch_of_cylinder(const Lens& lens, const Vec3& x, const Vec3& d) {
  const Vec3 from = lens.across(x), along(d[0], d[1], 0);
  return between_roots(along.squaredNorm(), from.dot(along),
                       from.squaredNorm() - lens.radius() * lens.radius());
}
Stretch stretch(const Plane& plane, const Vec3& x, const Vec3& d) {
  const double speed = plane.outwards.dot(d), distance = plane.distance(x);
  if (speed == 0) return distance < 0 ? whole : none;
  const double at = -distance / speed;
  return speed > 0 ? Stretch{-no_way, at} : Stretch{at, no_way};
}

/// Of a concave face, up to the plane of its edge.
Stretch before(const LensFace& face, const Vec3& x, const Vec3& d) {
  if (face.is_plane() || face.is_concave()) return stretch(face.edge_plane(), x, d);
  return stretch(face.sphere(), x, d);
}

}  // namespace

double way_out(const Lens& lens, const Vec3& x, const Vec3& d) {
  double way = std::max(0.0, stretch_of_cylinder(lens, x, d).to);
  for (const LensFace& face : lens.faces())
    way = std::min(way, face.is_plane()     ? way_out(face.edge_plane(), x, d)
                        : face.is_concave() ? way_in(face.sphere(), x, d)
                                            : way_out(face.sphere(), x, d));
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
    if (face.is_concave()) hollows[i] = stretch(face.sphere(), x, d);
  }
  const double rounding = 1e-14 * (lens.bounds().high - lens.bounds().low).norm();
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

#include "bench/oracles/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle::oracles {

namespace {

using Number = long double;
constexpr Number together = 1e-14L;

Long3 at(const Long3& x, Number t, const Long3& d) {
  return {x[0] + t * d[0], x[1] + t * d[1], x[2] + t * d[2]};
}
Number dot(const Long3& a, const Long3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Long3 unit(const Long3& a) {
  const Number length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}
Number square(Number a) {
  return a * a;
}

/// Appends the real roots t of a t^2 + 2 b t + c = 0.
void add_roots(Number a, Number b, Number c, std::vector<Number>& roots) {
  if (a == 0) {
    if (b != 0) roots.push_back(-c / (2 * b));
    return;
  }
  const Number under = b * b - a * c;
  if (under <= 0) return;
  const Number far = -(b + std::copysign(std::sqrt(under), b));
  roots.push_back(far / a);
  roots.push_back(c / far);
}

/// A sphere, or a circular cylinder along z. Its centre is at origin + arm. The origin is the
/// centre itself or a point of the surface, which keeps precision at any radius.
struct RoundSurface {
  Long3 origin, arm;
  Number radius;
  bool is_cylinder = false;

  Long3 from_origin(const Long3& x) const {
    return {x[0] - origin[0], x[1] - origin[1], is_cylinder ? 0 : x[2] - origin[2]};
  }
  Long3 from(const Long3& x) const { return at(from_origin(x), -1, arm); }
  /// Returns |x - centre|^2 - radius^2.
  Number power(const Long3& x) const {
    const Long3 p = from_origin(x);
    const bool starts_on_surface = dot(arm, arm) > 0;
    return dot(p, p) - 2 * dot(p, arm) - (starts_on_surface ? 0 : square(radius));
  }
  Number off(const Long3& x) const {
    return power(x) / (std::sqrt(dot(from(x), from(x))) + radius);
  }
  void add_crossings(const Long3& x, const Long3& d, std::vector<Number>& roots) const {
    const Long3 along{d[0], d[1], is_cylinder ? 0 : d[2]};
    add_roots(dot(along, along), dot(from(x), along), power(x), roots);
  }
};

/// Surfaces of a lens.
struct LensParts {
  Long3 vertex;
  Number radius;
  /// Radii of curvature of the two faces, and z of their vertices.
  std::array<Number, 2> curved, z;

  explicit LensParts(const std::array<double, 7>& s)
      : vertex{s[0], s[1], s[2]},
        radius(s[3]),
        curved{s[4], s[5]},
        z{s[2], static_cast<Number>(s[2]) + s[6]} {}

  RoundSurface barrel() const { return {vertex, {}, radius, true}; }
  RoundSurface sphere(int face) const {
    return {{vertex[0], vertex[1], z[face]}, {0, 0, curved[face]}, std::abs(curved[face])};
  }
  /// Returns z of a face at this squared distance from the axis.
  Number face_at(int face, Number rho_squared) const {
    if (curved[face] == 0) return z[face];
    const Number rest = std::sqrt(std::max<Number>(0, square(curved[face]) - rho_squared));
    return z[face] + rho_squared / (curved[face] + std::copysign(rest, curved[face]));
  }
};

}  // namespace

bool SolidBody::holds(const Long3& x) const {
  const auto& s = shape;
  if (kind == Kind::ball) return RoundSurface{{s[0], s[1], s[2]}, {}, s[3]}.off(x) < 0;
  if (kind == Kind::block) {
    for (std::size_t a = 0; a < 3; ++a)
      if (!(s[a] < x[a] && x[a] < s[a + 3])) return false;
    return true;
  }
  const LensParts lens(shape);
  const Long3 across = lens.barrel().from(x);
  const Number rho_squared = dot(across, across);
  return rho_squared < square(lens.radius) && x[2] > lens.face_at(0, rho_squared) &&
         x[2] < lens.face_at(1, rho_squared);
}

Number SolidBody::volume() const {
  const auto& s = shape;
  constexpr Number pi = std::numbers::pi_v<Number>;
  if (kind == Kind::ball) return 4 * pi / 3 * s[3] * s[3] * s[3];
  if (kind == Kind::block)
    return (static_cast<Number>(s[3]) - s[0]) * (static_cast<Number>(s[4]) - s[1]) *
           (static_cast<Number>(s[5]) - s[2]);
  const LensParts lens(shape);  // volume by the midpoint rule over rings of equal area
  constexpr int rings = 2000;
  Number sum = 0;
  for (int i = 0; i < rings; ++i) {
    const Number rho_squared = square(lens.radius) * (i + 0.5L) / rings;
    sum += (lens.face_at(1, rho_squared) - lens.face_at(0, rho_squared)) / rings;
  }
  return pi * square(lens.radius) * sum;
}

void SolidBody::add_crossings(const Long3& x, const Long3& d, std::vector<Number>& roots) const {
  const auto& s = shape;
  if (kind == Kind::ball)
    return RoundSurface{{s[0], s[1], s[2]}, {}, s[3]}.add_crossings(x, d, roots);
  if (kind == Kind::block) {
    for (std::size_t a = 0; a < 3; ++a)
      for (const double face : {s[a], s[a + 3]}) add_roots(0, d[a] / 2, x[a] - face, roots);
    return;
  }
  const LensParts lens(shape);
  lens.barrel().add_crossings(x, d, roots);
  for (int face = 0; face < 2; ++face) {
    if (lens.curved[face] == 0)
      add_roots(0, d[2] / 2, x[2] - lens.z[face], roots);
    else
      lens.sphere(face).add_crossings(x, d, roots);
  }
}

Long3 SolidBody::normal(const Long3& x) const {
  const auto& s = shape;
  if (kind == Kind::ball) return unit(RoundSurface{{s[0], s[1], s[2]}, {}, s[3]}.from(x));
  Number closest = 1e30L;
  Long3 normal{};
  const auto offer = [&](Number off, const Long3& of) {
    if (std::abs(off) >= closest) return;
    closest = std::abs(off);
    normal = of;
  };
  if (kind == Kind::block) {
    for (std::size_t a = 0; a < 3; ++a)
      for (const double face : {s[a], s[a + 3]}) {
        Long3 of{};
        of[a] = 1;
        offer(x[a] - face, of);
      }
    return normal;
  }
  const LensParts lens(shape);
  offer(lens.barrel().off(x), unit(lens.barrel().from(x)));
  for (int face = 0; face < 2; ++face) {
    if (lens.curved[face] == 0)
      offer(x[2] - lens.z[face], {0, 0, 1});
    else
      offer(lens.sphere(face).off(x), unit(lens.sphere(face).from(x)));
  }
  return normal;
}

namespace {

/// Finds the number of the body that contains a place, or -1 outside all bodies.
class Layering {
 public:
  explicit Layering(const SolidScene& scene) : scene_(scene) {
    std::vector<Number> volumes;
    for (const SolidBody& body : scene.bodies) {
      volumes.push_back(body.volume());
      const Number least = (1 - 1e-12L) * volumes.back();
      auto place = order_.begin();
      while (place != order_.end() && volumes[*place] >= least) ++place;
      order_.insert(place, static_cast<int>(volumes.size()) - 1);
    }
  }

  int at(const Long3& x) const {
    for (auto body = order_.rbegin(); body != order_.rend(); ++body)
      if (scene_.bodies[*body].holds(x)) return *body;
    return -1;
  }

 private:
  const SolidScene& scene_;
  std::vector<int> order_;
};

/// Next change of medium along a line. Crossings close together count as one.
struct NextChange {
  Number distance;
  int beyond;
  int surface;  ///< index of the body whose surface is crossed
  bool leaves;  ///< whether the ray leaves the domain
};

class SolidRayFollower {
 public:
  explicit SolidRayFollower(const SolidScene& scene) : scene_(scene), layering_(scene) {}

  std::optional<SolidRay> follow(const Long3& x, const Long3& d, const std::vector<bool>* reflects,
                                 int most_crossings) const {
    SolidRay ray{x, unit(d)};
    int in = layering_.at(at_first_midpoint(ray));
    while (true) {
      const auto next = next_change(ray, in);
      if (!next) return std::nullopt;
      go(ray, next->distance, in);
      if (next->leaves) return ray;
      if (index(next->beyond) == index(in)) {
        in = next->beyond;
        continue;
      }
      if (next->surface < 0 || ray.crossings == most_crossings) return std::nullopt;
      if (!jump(ray, in, *next, reflects)) return std::nullopt;
      if (layering_.at(at_first_midpoint(ray)) != in) return std::nullopt;
    }
  }

 private:
  double index(int body) const {
    return body < 0 ? scene_.index_around : scene_.bodies[body].index;
  }
  double extinction(int body) const {
    return body < 0 ? scene_.extinction_around : scene_.bodies[body].extinction;
  }

  /// Returns the distances of all crossings beyond the start, in ascending order.
  std::vector<Number> crossings(const SolidRay& ray) const {
    std::vector<Number> all;
    for (const SolidBody& body : scene_.bodies) body.add_crossings(ray.x, ray.d, all);
    scene_.domain.add_crossings(ray.x, ray.d, all);
    std::erase_if(all, [](Number t) { return !(t > together) || !std::isfinite(t); });
    std::sort(all.begin(), all.end());
    return all;
  }
  Long3 at_first_midpoint(const SolidRay& ray) const {
    const auto all = crossings(ray);
    return at(ray.x, all.empty() ? 0 : all.front() / 2, ray.d);
  }
  std::optional<NextChange> next_change(const SolidRay& ray, int in) const {
    const auto all = crossings(ray);
    for (std::size_t i = 0; i < all.size();) {
      std::size_t last = i;
      while (last + 1 < all.size() && all[last + 1] - all[last] < together) ++last;
      const Number after = last + 1 < all.size() ? all[last + 1] : all[last] + 1;
      const Number before = i > 0 ? all[i - 1] : 0;
      const Long3 here = at(ray.x, (before + all[i]) / 2, ray.d);
      const Long3 x = at(ray.x, (all[last] + after) / 2, ray.d);
      const bool leaves = !scene_.domain.holds(x);
      const int beyond = layering_.at(x);
      const bool enters =
          beyond >= 0 && scene_.bodies[beyond].holds(x) != scene_.bodies[beyond].holds(here);
      if (leaves || beyond != in) return NextChange{all[i], beyond, enters ? beyond : in, leaves};
      i = last + 1;
    }
    return std::nullopt;
  }
  void go(SolidRay& ray, Number distance, int in) const {
    ray.x = at(ray.x, distance, ray.d);
    ray.arc_length += distance;
    ray.optical_path += index(in) * distance;
    ray.transmitted *= std::exp(-extinction(in) * distance);
    ray.index = index(in);
  }
  /// Refracts or reflects a ray by Snell's and Fresnel's laws, in terms of the cosines of both
  /// angles.
  bool jump(SolidRay& ray, int& in, const NextChange& next,
            const std::vector<bool>* reflects) const {
    Long3 n = scene_.bodies[next.surface].normal(ray.x);
    Number c1 = dot(n, ray.d);
    if (c1 < 0) {
      for (Number& part : n) part = -part;
      c1 = -c1;
    }
    const Number n1 = index(in), n2 = index(next.beyond), ratio = n1 / n2;
    const Number sine_squared = ratio * ratio * (1 - c1 * c1);
    const bool is_total = sine_squared >= 1;
    const Number c2 = is_total ? 0 : std::sqrt(1 - sine_squared);
    const Number s = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2);
    const Number p = (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2);
    const Number reflectance = is_total ? 1 : (s * s + p * p) / 2;
    const auto number = static_cast<std::size_t>(ray.crossings);
    const bool reflected =
        reflects && number < reflects->size() ? bool((*reflects)[number]) : is_total;
    if (is_total && !reflected) return false;
    ++ray.crossings;
    ray.fresnel *= reflected ? reflectance : 1 - reflectance;
    if (reflected) {
      ray.d = unit(at(ray.d, -2 * c1, n));
    } else {
      Long3 refracted{};
      for (std::size_t a = 0; a < 3; ++a)
        refracted[a] = ratio * ray.d[a] + (c2 - ratio * c1) * n[a];
      ray.d = unit(refracted);
      in = next.beyond;
    }
    return true;
  }

  const SolidScene& scene_;
  Layering layering_;
};

bool is_same(const SolidRay& a, const SolidRay& b, Number limit) {
  Number most =
      std::max({std::abs(a.optical_path - b.optical_path), std::abs(a.arc_length - b.arc_length),
                std::abs(a.fresnel - b.fresnel), std::abs(a.transmitted - b.transmitted)});
  for (std::size_t i = 0; i < 3; ++i)
    most = std::max({most, std::abs(a.x[i] - b.x[i]), std::abs(a.d[i] - b.d[i])});
  return a.crossings == b.crossings && most <= limit;
}

}  // namespace

std::optional<SolidRay> follow(const SolidScene& scene, const Long3& x, const Long3& d,
                               const std::vector<bool>* reflects, int most_crossings) {
  return SolidRayFollower(scene).follow(x, d, reflects, most_crossings);
}

std::optional<SolidRay> follow_decided(const SolidScene& scene, const Long3& x, const Long3& d,
                                       const std::vector<bool>* reflects, int most_crossings) {
  const SolidRayFollower follower(scene);
  const auto ray = follower.follow(x, d, reflects, most_crossings);
  if (!ray) return std::nullopt;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const Number change : {-1e-13L, 1e-13L}) {
      Long3 beside = x, turned = d;
      beside[axis] += change;
      turned[axis] += change;
      for (const auto& other : {follower.follow(beside, d, reflects, most_crossings),
                                follower.follow(x, turned, reflects, most_crossings)})
        if (!other || !is_same(*ray, *other, 1e-10L)) return std::nullopt;
    }
  return ray;
}

}  // namespace flatspeckle::oracles

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "grin/media/geometry/vec3.h"
#include "grin/render/curved/ray_field_of.h"

namespace flatspeckle::grin {

/// A ray of Maxwell's fisheye in closed form (conventions, C27), lengths in units of its radius
/// from its centre: n = n0 / (1 + r^2), and rays are circles, x(s) = x + S w + C b, with the
/// curvature b = -2 (x - (x.w) w) / (1 + r^2), S = sin(ks)/k, C = (1 - cos(ks))/k^2, k = |b|. All
/// of it stays exact as k goes to 0, where the ray is straight.
class FisheyeOrbit {
 public:
  /// w: unit, along the ray.
  FisheyeOrbit(const Vec3& x, const Vec3& w)
      : x_(x),
        w_(w),
        over_(1 + x.squaredNorm()),
        outwards_(x.dot(w)),
        bend_(-2 / over_ * (x - outwards_ * w)),
        curvature_(bend_.norm()) {}

  double curvature() const { return curvature_; }
  double outwards() const { return outwards_; }
  const Vec3& start() const { return w_; }
  /// All around; infinite of a straight ray.
  double circumference() const { return 2 * std::numbers::pi / curvature_; }

  /// Where it is after an arc of s.
  struct Place {
    Vec3 x, w;
    double angle;  ///< optical path over n0/2
    double sigma;  ///< times n0
  };
  Place at(double s) const {
    const double half = curvature_ * s / 2;
    const double sine = s * sinc(2 * half), bulge = s * s / 2 * sinc(half) * sinc(half);
    return {x_ + sine * w_ + bulge * bend_,
            (1 - curvature_ * curvature_ * bulge) * w_ + sine * bend_, angle(s, half),
            over_ * s + 2 * bulge * outwards_ + 2 * lag(s, half) * (1 + x_.dot(bend_))};
  }

  /// The arc to where the ray leaves a sphere about the centre, in which it is; infinite where it
  /// never does. 0 of a ray on its way out from the sphere or beyond.
  double way_out(double radius) const {
    // r^2(s) - radius^2 is a quadratic in q = 2/k tan(ks/2), over 1 + (kq/2)^2
    const double inside = x_.squaredNorm() - radius * radius;
    if (inside >= 0 && outwards_ >= 0) return 0;
    const double square = inside * curvature_ * curvature_ / 4 + 1 + x_.dot(bend_);
    const double root = outwards_ * outwards_ - square * inside;
    if (root < 0) return inside < 0 ? std::numeric_limits<double>::infinity() : 0;
    const double q = outwards_ > 0 ? -inside / (outwards_ + std::sqrt(root))
                                   : (std::sqrt(root) - outwards_) / square;
    if (!(curvature_ > 0)) return q;
    const double s = 2 / curvature_ * std::atan(curvature_ * q / 2);
    return s >= 0 ? s : s + circumference();
  }

 private:
  static double sinc(double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; }
  /// (s - S) / k^2.
  double lag(double s, double half) const {
    const double y = 4 * half * half;  // (ks)^2
    if (y < 0.01) return s * s * s / 6 * (1 - y / 20 * (1 - y / 42 * (1 - y / 72)));
    return (s - s * sinc(2 * half)) / (curvature_ * curvature_);
  }
  /// Between the two points on the sphere of which space is the image (stereographic).
  double angle(double s, double half) const {
    const double rounds = std::floor(half / std::numbers::pi);
    const double rest = half - rounds * std::numbers::pi;
    const double across = rounds > 0 ? 2 * std::sin(rest) / curvature_ : s * sinc(half);
    return 2 * (std::atan2(across, over_ * std::cos(rest) + outwards_ * across) +
                rounds * std::numbers::pi);
  }

  Vec3 x_, w_;
  double over_, outwards_;  ///< 1 + r^2, x.w
  Vec3 bend_;
  double curvature_;
};

/// The two ways between two points (apart, and not images of each other): the two arcs of one
/// circle, the first of which is less than half of all ways around by optical path.
struct FisheyeWays {
  Vec3 from;
  Vec3 start, end;        ///< unit, of the first; those of the second are opposite
  double arc, angle;      ///< of the first
  double root_spreading;  ///< sqrt |J| of both; 0 where the points are images

  FisheyeWays(const Vec3& x0, const Vec3& x1) : from(x0) {
    const double over = 1 + x0.squaredNorm(), apart = (x1 - x0).squaredNorm();
    const Vec3 along = x1 - x0 + apart / over * x0;
    start = along.normalized();
    const FisheyeOrbit orbit(x0, start);
    const double sine = along.norm() - apart / over * orbit.outwards(), k = orbit.curvature();
    arc = k > 0 ? 2 / k * std::atan2(k * apart / 2, sine) : apart / sine;
    end = orbit.at(arc).w;
    const double distance = std::sqrt(apart);
    const double from_image = std::hypot(1 + x0.dot(x1), x0.cross(x1).norm());
    angle = 2 * std::atan2(distance, from_image);
    root_spreading = distance * from_image / over;
  }
};

/// A place and a direction in the fisheye, in units of its radius, as stereographic projection has
/// them on the unit sphere of four dimensions, and what is beside them.
struct OnSphere {
  using Vec4 = Eigen::Vector4d;
  Vec3 x, w;
  double over, outwards;  ///< 1 + r^2; fourth component of the direction

  OnSphere(const Vec3& at, const Vec3& direction)
      : x(at), w(direction), over(1 + at.squaredNorm()), outwards(2 * at.dot(direction) / over) {}

  struct Lifted {
    Vec4 x, w;
  };
  Lifted lifted(const Vec3& dx, const Vec3& dw) const {
    const double away = 2 * x.dot(dx) / over;
    const double more_outwards = 2 * (dx.dot(w) + x.dot(dw)) / over - outwards * away;
    return {2 / over * four(dx - away * x, away),
            four(dw - outwards * dx - more_outwards * x, more_outwards)};
  }
  struct Lowered {
    Vec3 x, w;
  };
  Lowered lowered(const Vec4& dx, const Vec4& dw) const {
    const Vec3 moved = over / 2 * (dx.head<3>() + dx(3) * x);
    return {moved, dw.head<3>() + outwards * moved + dw(3) * x};
  }

 private:
  static Vec4 four(const Vec3& space, double fourth) {
    return {space.x(), space.y(), space.z(), fourth};
  }
};

/// Rays of Maxwell's fisheye that end on a sphere about its centre: closed forms instead of steps,
/// and all curves between two points.
class FisheyeRays final : public RayFieldOf<Fisheye> {
 public:
  /// radius: of the sphere.
  FisheyeRays(const Fisheye& field, double radius)
      : RayFieldOf(field),
        centre_(field.centre()),
        unit_(field.profile().radius),
        index_(1 + field.profile().centre_excess),
        radius_(radius / unit_) {}

  bool has_lanes() const override { return false; }
  LegStop fly(const LegRoom& room, double longest, double& weight, RandomStream& random,
              RayState& ray, RayTangent* tangent) const override {
    if (room.medium.grid()) return RayFieldOf::fly(room, longest, weight, random, ray, tangent);
    const FisheyeOrbit orbit(in_units(ray.x), ray.v.normalized());
    const double out = unit_ * orbit.way_out(radius_ - 1e-9 / 8 * room.step / unit_);
    const double collision = room.medium.scatters()
                                 ? sample_free_flight(room.medium.majorant(), random.uniform())
                                 : std::numeric_limits<double>::infinity();
    const double arc = std::min(out, collision);
    if (!(arc <= longest)) return LegStop::lost;
    move(orbit, arc, ray, tangent);
    return collision < out ? LegStop::collision : LegStop::surface;
  }

  double cost_of_curve() const override { return 0.5; }
  double cost_of_closed_curve() const override { return 2.5; }
  ConnectionEstimate connect(const CurveEnds& ends, const ConnectionOptions& options,
                             RandomStream& random,
                             ConnectionStatistics& statistics) const override {
    const ConnectionEstimate found = one_of_ways(ends, options, random);
    statistics.add_pair(found.outcome);
    return found;
  }

 private:
  static constexpr double full = 2 * std::numbers::pi;
  /// Of the ways around a circle that is all inside, each is this much less likely than the one
  /// before.
  static constexpr double once_more = 0.25;

  Vec3 in_units(const Vec3& x) const { return (x - centre_) / unit_; }

  ConnectionEstimate one_of_ways(const CurveEnds& ends, const ConnectionOptions& options,
                                 RandomStream& random) const {
    const Vec3 from = in_units(ends.from), to = in_units(ends.to);
    const FisheyeWays ways(from, to);
    if (!(ways.root_spreading > 0)) return {TrialOutcome::degenerate, std::nullopt, 0};
    const double end = radius_ + ends.region.tolerance / unit_;
    const FisheyeOrbit first(from, ways.start);
    const double out = first.way_out(end), around = first.circumference();
    if (out >= ways.arc && std::isfinite(out))
      return way(ways, ways.arc, ways.angle, 1, 1, options);
    if (std::isfinite(out)) {
      const double other = around - ways.arc;
      if (!(FisheyeOrbit(from, -ways.start).way_out(end) >= other))
        return {TrialOutcome::left_region, std::nullopt, 0};
      return way(ways, other, full - ways.angle, -1, 1, options);
    }
    const double chance = 1 - ways.arc / around;  // of the first: longer ways bring less
    const bool is_first = random.uniform() < chance;
    double rounds = 0, likely = (is_first ? chance : 1 - chance) * (1 - once_more);
    for (; random.uniform() < once_more; ++rounds) likely *= once_more;
    return way(ways, (is_first ? ways.arc : around - ways.arc) + rounds * around,
               (is_first ? ways.angle : full - ways.angle) + rounds * full, is_first ? 1 : -1,
               1 / likely, options);
  }

  ConnectionEstimate way(const FisheyeWays& ways, double arc, double angle, int sense,
                         double multiplicity, const ConnectionOptions& options) const {
    if (!(unit_ * arc <= options.max_length)) return {TrialOutcome::too_long, std::nullopt, 0};
    const FisheyeOrbit::Place place = FisheyeOrbit(ways.from, sense * ways.start).at(arc);
    const double across = unit_ * ways.root_spreading, sigma = unit_ / index_ * place.sigma;
    return {TrialOutcome::converged,
            Connection{sense * ways.start, sense * ways.end, sigma, unit_ * arc,
                       unit_ * index_ / 2 * angle, across * across, sense,
                       static_cast<int>(std::ceil(sigma / options.step))},
            multiplicity};
  }

  void move(const FisheyeOrbit& orbit, double arc, RayState& ray, RayTangent* tangent) const {
    const FisheyeOrbit::Place place = orbit.at(arc / unit_);
    const double n = index_ / (1 + place.x.squaredNorm());
    if (tangent) turn({in_units(ray.x), orbit.start()}, ray.v.norm(), place, n, *tangent);
    ray.arc_length += arc;
    ray.optical_path += unit_ * index_ / 2 * place.angle;
    ray.x = centre_ + unit_ * place.x;
    ray.v = n * place.w;
  }

  /// Rays beside one turn with it on the sphere of which space is the image; all by the same angle,
  /// which differs from the same sigma by a shift along the ray alone.
  void turn(const OnSphere& from, double n_from, const FisheyeOrbit::Place& place, double n,
            RayTangent& tangent) const {
    const OnSphere to(place.x, place.w);
    const double cosine = std::cos(place.angle), sine = std::sin(place.angle);
    for (int column = 0; column < 3; ++column) {
      const Vec3 v = tangent.dv.col(column);
      const auto [dx, dw] =
          from.lifted(tangent.dx.col(column) / unit_, (v - from.w.dot(v) * from.w) / n_from);
      const auto [x, w] = to.lowered(cosine * dx + sine * dw, cosine * dw - sine * dx);
      tangent.dx.col(column) = unit_ * x;
      tangent.dv.col(column) = n * (w - 2 / to.over * to.x.dot(x) * to.w);
    }
  }

  Vec3 centre_;
  double unit_, index_, radius_;
};

/// Nothing where there is no closed form.
inline std::unique_ptr<const RayField> closed_form_within(const Fisheye& field, const Sphere& end) {
  const bool fits = (end.centre - field.centre()).norm() <= 1e-12 * field.profile().radius;
  return fits ? std::make_unique<FisheyeRays>(field, end.radius) : nullptr;
}

}  // namespace flatspeckle::grin

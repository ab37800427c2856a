#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "grin/media/geometry/vec3.h"
#include "grin/render/curved/ray_field_of.h"

namespace flatspeckle::grin {

/// A ray of Maxwell's fisheye in closed form (conventions, C27). Lengths are in units of the
/// fisheye's radius, and positions are relative to its centre, so that n = n0 / (1 + r^2). A ray
/// from x along w is a circle,
///   x(s) = x + S w + C b,  S = sin(ks)/k,  C = (1 - cos(ks))/k^2,
/// with the curvature b = -2 (x - (x.w) w) / (1 + r^2), k = |b|. The formulas remain accurate as k
/// goes to 0, where the ray is straight.
class FisheyeOrbit {
 public:
  /// w: unit direction of the ray.
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
  /// Circumference of the circle; infinite for a straight ray.
  double circumference() const { return 2 * std::numbers::pi / curvature_; }

  /// State of the ray after an arc of length s.
  struct Place {
    Vec3 x, w;
    double angle;  ///< optical path, divided by n0/2
    double sigma;  ///< ray parameter sigma, multiplied by n0
  };
  Place at(double s) const {
    const double half = curvature_ * s / 2;
    const double sine = s * sinc(2 * half), bulge = s * s / 2 * sinc(half) * sinc(half);
    return {x_ + sine * w_ + bulge * bend_,
            (1 - curvature_ * curvature_ * bulge) * w_ + sine * bend_, angle(s, half),
            over_ * s + 2 * bulge * outwards_ + 2 * lag(s, half) * (1 + x_.dot(bend_))};
  }

  /// Returns the arc length at which the ray leaves the sphere of this radius about the centre;
  /// infinite if the ray never leaves it, 0 for an outgoing ray that starts on or beyond the
  /// sphere.
  double exit_distance(double radius) const {
    // r^2(s) - radius^2 is a quadratic in q = 2/k tan(ks/2), divided by 1 + (kq/2)^2
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
  /// Returns (s - S) / k^2, where S = sin(ks)/k.
  double lag(double s, double half) const {
    const double y = 4 * half * half;  // (ks)^2
    if (y < 0.01) return s * s * s / 6 * (1 - y / 20 * (1 - y / 42 * (1 - y / 72)));
    return (s - s * sinc(2 * half)) / (curvature_ * curvature_);
  }
  /// Returns the angle, on the unit sphere of four dimensions, between the stereographic
  /// projections of the start and the end of an arc of length s. half: k s / 2, with k the
  /// curvature of the arc.
  double angle(double s, double half) const {
    const double rounds = std::floor(half / std::numbers::pi);
    const double rest = half - rounds * std::numbers::pi;
    const double across = rounds > 0 ? 2 * std::sin(rest) / curvature_ : s * sinc(half);
    return 2 * (std::atan2(across, over_ * std::cos(rest) + outwards_ * across) +
                rounds * std::numbers::pi);
  }

  Vec3 x_, w_;
  double over_, outwards_;  ///< 1 + r^2 and x.w at the start of the ray
  Vec3 bend_;
  double curvature_;
};

/// The two rays that connect two distinct points. They are the two arcs of one circle; the first
/// has less than half of the optical path of the circle. If one point is the optical image of the
/// other, all rays from it arrive there, and the two arcs are not defined.
struct FisheyeArcs {
  Vec3 from;
  /// Unit tangents at the two ends of the first arc; those of the second arc are opposite.
  Vec3 start, end;
  /// Length of the first arc, and its optical path divided by n0/2.
  double arc, angle;
  double root_spreading;  ///< sqrt |J| of both arcs; 0 if one point is the image of the other

  FisheyeArcs(const Vec3& x0, const Vec3& x1) : from(x0) {
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

/// Stereographic projection of a position and a direction in the fisheye to the unit sphere of four
/// dimensions. lifted() projects displacements of the two to the sphere, lowered() projects such
/// displacements back. Lengths are in units of the fisheye's radius.
struct OnSphere {
  using Vec4 = Eigen::Vector4d;
  Vec3 x, w;
  double over, outwards;  ///< 1 + r^2; fourth component of the projected direction

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

/// Rays of Maxwell's fisheye inside a sphere about its centre, computed in closed form instead of
/// by numerical steps. connect() selects one of all curves between two points at random.
class FisheyeRays final : public RayFieldOf<Fisheye> {
 public:
  /// radius: radius of the sphere on which rays end.
  FisheyeRays(const Fisheye& field, double radius)
      : RayFieldOf(field),
        centre_(field.centre()),
        unit_(field.profile().radius),
        index_(1 + field.profile().centre_excess),
        radius_(radius / unit_) {}

  bool has_lanes() const override { return false; }
  SegmentStop fly(const SegmentDomain& domain, double longest, double& weight, RandomStream& random,
                  RayState& ray, RayTangent* tangent) const override {
    if (domain.medium.varies())
      return RayFieldOf::fly(domain, longest, weight, random, ray, tangent);
    const FisheyeOrbit orbit(in_units(ray.x), ray.v.normalized());
    const double out = unit_ * orbit.exit_distance(radius_ - 1e-9 / 8 * domain.step / unit_);
    const double collision = domain.medium.scatters()
                                 ? sample_free_flight(domain.medium.majorant(), random.uniform())
                                 : std::numeric_limits<double>::infinity();
    const double arc = std::min(out, collision);
    if (!(arc <= longest)) return SegmentStop::lost;
    move(orbit, arc, ray, tangent);
    return collision < out ? SegmentStop::collision : SegmentStop::surface;
  }

  double cost_of_curve() const override { return 0.5; }
  double cost_of_closed_curve() const override { return 2.5; }
  ConnectionEstimate connect(const CurveEndpoints& ends, const ConnectionOptions& options,
                             RandomStream& random,
                             ConnectionStatistics& statistics) const override {
    const ConnectionEstimate found = one_of_curves(ends, options, random);
    statistics.add_pair(found.outcome);
    return found;
  }

 private:
  static constexpr double full = 2 * std::numbers::pi;
  /// Probability with which a random connection goes around its circle once more, if the circle is
  /// entirely inside the sphere.
  static constexpr double once_more = 0.25;

  Vec3 in_units(const Vec3& x) const { return (x - centre_) / unit_; }

  ConnectionEstimate one_of_curves(const CurveEndpoints& ends, const ConnectionOptions& options,
                                   RandomStream& random) const {
    const Vec3 from = in_units(ends.from), to = in_units(ends.to);
    const FisheyeArcs arcs(from, to);
    if (!(arcs.root_spreading > 0)) return {TrialOutcome::degenerate, std::nullopt, 0};
    const double end = radius_ + ends.region.tolerance / unit_;
    const FisheyeOrbit first(from, arcs.start);
    const double out = first.exit_distance(end), around = first.circumference();
    if (out >= arcs.arc && std::isfinite(out))
      return along_arc(arcs, arcs.arc, arcs.angle, 1, 1, options);
    if (std::isfinite(out)) {
      const double other = around - arcs.arc;
      if (!(FisheyeOrbit(from, -arcs.start).exit_distance(end) >= other))
        return {TrialOutcome::left_region, std::nullopt, 0};
      return along_arc(arcs, other, full - arcs.angle, -1, 1, options);
    }
    // probability of selecting the first arc; the shorter an arc is, the more it contributes
    const double probability = 1 - arcs.arc / around;
    const bool is_first = random.uniform() < probability;
    double rounds = 0, likely = (is_first ? probability : 1 - probability) * (1 - once_more);
    for (; random.uniform() < once_more; ++rounds) likely *= once_more;
    return along_arc(arcs, (is_first ? arcs.arc : around - arcs.arc) + rounds * around,
                     (is_first ? arcs.angle : full - arcs.angle) + rounds * full, is_first ? 1 : -1,
                     1 / likely, options);
  }

  ConnectionEstimate along_arc(const FisheyeArcs& arcs, double arc, double angle, int sense,
                               double multiplicity, const ConnectionOptions& options) const {
    if (!(unit_ * arc <= options.max_length)) return {TrialOutcome::too_long, std::nullopt, 0};
    const FisheyeOrbit::Place place = FisheyeOrbit(arcs.from, sense * arcs.start).at(arc);
    const double across = unit_ * arcs.root_spreading, sigma = unit_ / index_ * place.sigma;
    return {TrialOutcome::converged,
            Connection{sense * arcs.start, sense * arcs.end, sigma, unit_ * arc,
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

  /// Advances the derivatives of neighbouring rays. On the unit sphere of four dimensions all rays
  /// turn by the same angle; neighbouring rays at the same sigma differ from this only by a shift
  /// along the ray.
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

/// Returns closed-form rays that end on the sphere `end`; null if it is not about the fisheye's
/// centre.
inline std::unique_ptr<const RayField> closed_form_within(const Fisheye& field, const Sphere& end) {
  const bool fits = (end.centre - field.centre()).norm() <= 1e-12 * field.profile().radius;
  return fits ? std::make_unique<FisheyeRays>(field, end.radius) : nullptr;
}

}  // namespace flatspeckle::grin

#pragma once

#include <numbers>

#include "grin/render/curved/fisheye_orbit.h"
#include "grin/render/curved/ray_field_of.h"

namespace flatspeckle::grin {

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
    ++statistics.pairs;
    const ConnectionEstimate found = one_of_ways(ends, options, random);
    ++statistics.outcomes[static_cast<int>(found.outcome)];
    statistics.found += found.curve.has_value();
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

#pragma once

#include "grin/media/fields/parabolic.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/render/curved/parabolic_ways.h"
#include "grin/render/curved/ray_field_of.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// Whether closed forms keep their digits: in a weaker guide two places have one curve, nearly
/// straight, which any trial finds.
inline bool bends_within(const ParabolicGuide& field, const Surface& room) {
  constexpr double least_turn = 1e-2;
  const Box box = bounds(room);
  return field.profile().alpha * (box.high - box.low).norm() > least_turn;
}

/// Rays of the parabolic guide in a room, by steps, but for the curves between two points: closed
/// forms, one at random of all that there are.
class ParabolicRays final : public RayFieldOf<ParabolicGuide> {
 public:
  ParabolicRays(const ParabolicGuide& field, const Surface& room)
      : RayFieldOf(field),
        centre_(field.centre()),
        n0_(1 + field.profile().axis_excess),
        alpha_(field.profile().alpha) {
    const Box box = bounds(room);
    const Vec3 far = (box.low - centre_).cwiseAbs().cwiseMax((box.high - centre_).cwiseAbs());
    reach_squared_ = far.head<2>().squaredNorm();
  }

  double cost_of_curve() const override { return 1; }
  double cost_of_closed_curve() const override { return 2; }
  ConnectionEstimate connect(const CurveEnds& ends, const ConnectionOptions& options,
                             RandomStream& random,
                             ConnectionStatistics& statistics) const override {
    ++statistics.pairs;
    ConnectionEstimate found{TrialOutcome::no_approach, std::nullopt, 0};
    const Vec3 from = ends.from - centre_, to = ends.to - centre_;
    ParabolicWays(n0_, alpha_, from, to)
        .each(longest(to[2] - from[2], options), [&](double t, const Vec3& v) {
          Connection curve;
          const TrialOutcome outcome = judge({n0_, alpha_, from, v}, t, ends, options, curve);
          if (!found.curve) found.outcome = outcome;
          if (outcome != TrialOutcome::converged) return;
          if (random.uniform() * ++found.multiplicity < 1) found.curve = curve;
        });
    ++statistics.outcomes[static_cast<int>(found.outcome)];
    statistics.found += found.curve.has_value();
    return found;
  }

 private:
  /// t of a way along the axis: what is longer swings out of the room or is too long. The mean of
  /// n^2 on a way is at least half of what it is on the axis.
  double longest(double along, const ConnectionOptions& options) const {
    const double by_length = alpha_ * 2 * options.max_length / n0_ + 1;
    const double on_axis = n0_ / alpha_ * n0_ / alpha_ - reach_squared_;
    if (!(on_axis > 0)) return by_length;
    return std::min(by_length, std::max(std::numbers::pi, std::abs(along) / std::sqrt(on_axis)));
  }

  TrialOutcome judge(const ParabolicOrbit& orbit, double t, const CurveEnds& ends,
                     const ConnectionOptions& options, Connection& curve) const {
    const RayState start = orbit.at(0), end = orbit.at(t);
    if (!(end.arc_length <= options.max_length)) return TrialOutcome::too_long;
    const double sigma = t / alpha_, n = start.v.norm();
    const Vec3 first = start.v / n, last = end.v.normalized();
    const double spreading = signed_spreading(orbit.tangent_at(t), n, first, last);
    if (!(std::abs(spreading) > 0)) return TrialOutcome::degenerate;
    const int steps = static_cast<int>(std::ceil(sigma / options.step));
    if (!keeps(orbit, sigma / steps, steps, ends.region)) return TrialOutcome::left_region;
    curve = {first,
             last,
             sigma,
             end.arc_length,
             end.optical_path,
             std::abs(spreading),
             spreading < 0 ? -1 : 1,
             steps};
    return TrialOutcome::converged;
  }

  bool keeps(const ParabolicOrbit& orbit, double h, int steps, const Sides& region) const {
    RayState before = placed(orbit, 0);
    for (int i = 1; i <= steps; ++i) {
      const RayState here = placed(orbit, i * h);
      if (!region.keep(before, here, h)) return false;
      before = here;
    }
    return true;
  }
  /// Arc lengths are no less than on the ray.
  RayState placed(const ParabolicOrbit& orbit, double sigma) const {
    RayState ray = orbit.place_at(alpha_ * sigma);
    ray.x += centre_;
    ray.arc_length = n0_ * sigma;
    return ray;
  }

  Vec3 centre_;
  double n0_, alpha_;
  double reach_squared_;  ///< of the room, from the axis
};

}  // namespace flatspeckle::grin

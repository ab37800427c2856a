#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numbers/random.h"
#include "grin/rays/connections/connection.h"
#include "grin/rays/connections/damped_step.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::grin {

namespace connection_parts {

/// Integrator for rays that end far from Q: Leapfrog, unless the integrator Step defines another
/// one as Step::Rough.
template <class Step>
struct RoughStep {
  using type = Leapfrog;
};
template <class Step>
requires requires {
  typename Step::Rough;
}
struct RoughStep<Step> {
  using type = typename Step::Rough;
};

/// Whether the integrator Step is no more accurate than its rough integrator, so that Step alone
/// is used.
template <class Step, class F>
bool is_rough(const F& field) {
  if constexpr (requires { Step::is_rough(field); })
    return Step::is_rough(field);
  else
    return std::same_as<Step, Leapfrog>;
}

}  // namespace connection_parts

/// Finds curves from P to Q through a field, inside a region, with an integrator of ray_step.h. A
/// trial (conventions, C26) samples a start direction, traces its ray, and chooses one of the
/// points of closest approach to Q. From there, damped Gauss-Newton steps adjust the direction and
/// length of the ray until it ends at Q. While the end is far from Q, rays use Leapfrog, which is
/// cheaper.
///
/// A curve consists of equal steps. Their number depends only on the length of the curve in sigma,
/// so that the reverse curve is the same.
template <IndexField F, Region R, class Step = Sharma>
class ConnectionTrial {
 public:
  /// Keeps a reference to the field. P and Q may coincide; every trial is then degenerate.
  ConnectionTrial(const F& field, const R& region, const Vec3& from, const Vec3& to,
                  const ConnectionOptions& options)
      : field_(field),
        region_(region),
        from_(from),
        to_(to),
        options_(options),
        n_from_(index(field, from)),
        gap_((to - from).norm()),
        rounding_(1e-15 * std::max(from.norm(), to.norm())) {}

  struct Result {
    TrialOutcome outcome;
    Connection curve;  ///< valid if converged; caustics are not counted
  };

  Result run(RandomStream& random, ConnectionStatistics& statistics) const {
    return trial(statistics, [&] {
      const Vec3 direction = options_.start.sample((to_ - from_) / gap_, random);
      return rough(direction, draw_approach(direction, random, statistics));
    });
  }

  /// Makes the deterministic trial whose first ray starts along the chord, the straight line from P
  /// to Q, and ends at its first closest approach to Q.
  Result along_chord(ConnectionStatistics& statistics) const {
    return trial(statistics, [&] {
      const Vec3 direction = (to_ - from_) / gap_;
      double first = 0;
      each_approach(direction, statistics, [&](double sigma, double) {
        first = sigma;
        return false;
      });
      return rough(direction, first);
    });
  }

  /// Whether a curve is nearly straight, and rays next to it spread about as much as straight rays.
  bool is_nearly_straight(const Connection& curve) const {
    const double spread = curve.spreading / (gap_ * gap_);
    return curve.start_direction.dot(to_ - from_) > 0.9 * gap_ && spread > 0.3 && spread < 3;
  }

  /// Returns the straight line from P to Q, which is the exact curve.
  Result straight() const requires HomogeneousField<F> {
    if (coincident()) return {TrialOutcome::degenerate, {}};
    if (gap_ > options_.max_length) return {TrialOutcome::too_long, {}};
    const Vec3 direction = (to_ - from_) / gap_;
    const int steps = steps_for(gap_ / n_from_);
    for (int i = 1; i < steps; ++i)
      if (!region_(from_ + gap_ * i / steps * direction)) return {TrialOutcome::left_region, {}};
    return {TrialOutcome::converged,
            {direction, direction, gap_ / n_from_, gap_, n_from_ * gap_, gap_ * gap_, 1, steps, 0}};
  }

  /// Returns the curve with the number of its caustics, which are counted by tracing it.
  Connection with_caustics(Connection curve, ConnectionStatistics& statistics) const {
    curve.caustics =
        follow({curve.start_direction, curve.sigma, curve.steps, true}, statistics).count();
    return curve;
  }

  const ConnectionOptions& options() const { return options_; }

 private:
  using Rough = typename connection_parts::RoughStep<Step>::type;
  // Ratio of beam width to ray length at Q below which a curve is tested for caustics
  static constexpr double suspicious = 1e-2;
  // Distance from Q, in units of |PQ|, within which rays use the accurate integrator Step
  static constexpr double near = 1e-2;
  // Largest number of steps, for rays that cross regions where the index is near 0
  static constexpr int most_steps = 1 << 20;

  struct Aim {
    Vec3 direction;  // start direction, a unit vector
    double sigma;
    int steps;
    bool precise;
    bool raised = false;  // whether the last change of the number of steps was an increase
  };
  struct Shot {
    RayState end;
    RayTangent tangent = {};
    bool inside = true;   // whether the ray stays in the region
    bool uniform = true;  // whether all steps are equal
    Vec3 error = {};      // vector from Q to the end of the ray; its length is `miss`
    double miss = 0;
  };

  Aim rough(const Vec3& direction, double sigma) const {
    return {direction, sigma, steps_for(sigma), connection_parts::is_rough<Step>(field_)};
  }

  /// Whether P and Q are so close that the rounding of directions prevents distinguishing curves.
  bool coincident() const { return gap_ * std::min(options_.same, 1e-3) <= rounding_; }

  int steps_for(double sigma) const {
    const double steps = std::ceil(sigma / options_.step);
    return steps < most_steps ? std::max(1, static_cast<int>(steps)) : most_steps;
  }

  /// Makes a trial; begin() returns the direction and the length of its first ray.
  template <class Begin>
  Result trial(ConnectionStatistics& statistics, const Begin& begin) const {
    Result result{TrialOutcome::degenerate, {}};
    if (!coincident()) {
      const Aim aim = begin();
      result = aim.sigma > 0 ? refine(aim, statistics) : Result{TrialOutcome::no_approach, {}};
    }
    statistics.add(result.outcome);
    return result;
  }

  /// Samples one of the points where a ray is closest to Q with weights 1 / distance^2 and returns
  /// its sigma, 0 if there is none. The end of a ray that still approaches Q counts as such a
  /// point.
  double draw_approach(const Vec3& direction, RandomStream& random,
                       ConnectionStatistics& statistics) const {
    double drawn = 0, total = 0;
    each_approach(direction, statistics, [&](double sigma, double distance_squared) {
      const double weight = 1 / (distance_squared + 1e-4 * gap_ * gap_);
      total += weight;
      if (random.uniform() * total <= weight) drawn = sigma;
      return true;
    });
    return drawn;
  }

  /// Calls offer(sigma, squared distance from Q) for each point where a ray is closest to Q, until
  /// offer() returns false.
  template <class Offer>
  void each_approach(const Vec3& direction, ConnectionStatistics& statistics,
                     const Offer& offer) const {
    const double h = options_.step;
    RayState ray = start_ray(field_, from_, direction);
    double nearing = (to_ - ray.x).dot(ray.v);
    for (int i = 0; i < most_steps; ++i) {
      const RayState before = ray;
      const double was_nearing = nearing;
      Rough::step(field_, ray, h);
      ++statistics.guess_steps;
      // The ray is lost where the index is not positive
      if (!(ray.arc_length > before.arc_length)) return;
      nearing = (to_ - ray.x).dot(ray.v);
      if (was_nearing > 0 && nearing <= 0) {
        const double part = was_nearing / (was_nearing - nearing);
        const Vec3 x = before.x + part * (ray.x - before.x);
        if (!offer((i + part) * h, (x - to_).squaredNorm())) return;
      }
      if (ray.arc_length > options_.max_length || !region_(ray.x)) {
        if (nearing > 0) offer((i + 1) * h, (ray.x - to_).squaredNorm());
        return;
      }
    }
  }

  Shot shoot(const Aim& aim, ConnectionStatistics& statistics) const {
    return aim.precise ? shoot_by<Step>(aim, statistics.tangent_steps)
                       : shoot_by<Rough>(aim, statistics.rough_steps);
  }

  template <class Integrator>
  Shot shoot_by(const Aim& aim, std::uint64_t& steps_made) const {
    Shot shot{.end = start_ray(field_, from_, aim.direction)};
    const double h = aim.sigma / aim.steps, longest = 2 * options_.max_length;
    int i = 0;
    for (; i < aim.steps && shot.end.arc_length <= longest; ++i) {
      const RayState before = shot.end;
      Integrator::step(field_, shot.end, shot.tangent, h);
      shot.inside = shot.inside && keeps(before, shot.end, h);
    }
    steps_made += i;
    shot.error = shot.end.x - to_;
    // NaN if the ray is lost or longer than twice max_length
    shot.miss = shot.end.arc_length <= longest ? shot.error.norm() : std::nan("");
    return shot;
  }

  /// Whether a step of the ray stays in the region. The two end points of the ray are not tested.
  bool keeps(const RayState& start, const RayState& end, double h) const {
    if constexpr (requires { region_.keep(start, end, h); })
      return region_.keep(start, end, h);
    else
      return start.arc_length == 0 || region_(start.x);
  }

  CausticCount follow(const Aim& aim, ConnectionStatistics& statistics) const {
    RayState ray = start_ray(field_, from_, aim.direction);
    RayTangent tangent;
    CausticCount caustics(n_from_, aim.direction);
    for (int i = 0; i < aim.steps; ++i) {
      Step::step(field_, ray, tangent, aim.sigma / aim.steps);
      caustics.pass(ray, tangent);
    }
    statistics.tangent_steps += aim.steps;
    return caustics;
  }

  Result refine(Aim aim, ConnectionStatistics& statistics) const {
    Shot shot = shoot(aim, statistics);
    DampedStep damped;
    // Distance from Q of the end of the previous ray, if it had the same number of steps
    double miss_before = std::numeric_limits<double>::infinity();
    for (int i = 0; i < options_.max_iterations && !damped.stuck(); ++i) {
      if (!aim.precise && shot.miss <= near * gap_) {
        aim.precise = true;
        shot = shoot(aim, statistics);
        miss_before = std::numeric_limits<double>::infinity();
      }
      if (arrived(aim, shot)) {
        if (shot.uniform && has_its_steps(aim)) return judge(aim, shot, statistics);
        aim.raised = steps_for(aim.sigma) > aim.steps;
        aim.steps = steps_for(aim.sigma);
        shot = shoot(aim, statistics);
        continue;  // usually the ray still ends at Q, and rounding prevents any further improvement
      }
      Aim next = moved(aim, shot, damped);
      if (next.steps != aim.steps) miss_before = std::numeric_limits<double>::infinity();
      const double left = shot.miss * std::pow(shot.miss / miss_before, 2);
      if (shot.uniform && has_its_steps(next) && ends_on_target(aim, shot, left))
        return judge(next, carried(aim, shot, next, left), statistics);
      Shot tried = shoot(next, statistics);
      ++statistics.iterations;
      if (tried.miss >= shot.miss / 2) next.sigma += draw_near(tried, next.sigma);
      if (tried.miss < shot.miss) {
        damped.succeeded(tried.miss / shot.miss);
        miss_before = next.steps == aim.steps ? shot.miss : std::numeric_limits<double>::infinity();
        aim = next;
        shot = tried;
      } else {
        damped.failed();
      }
    }
    return {judge_failure(aim, shot, statistics), {}};
  }

  /// Whether the ray ends so close to Q that its start direction is accurate enough.
  bool arrived(const Aim& aim, const Shot& shot) const {
    const double rounding = rounding_ * std::sqrt(aim.steps);
    if (!aim.precise || !(shot.miss <= std::max(rounding, options_.tolerance * gap_))) return false;
    return shot.miss <= std::max(rounding, options_.same / 10 * end_widths(aim, shot).narrow);
  }

  /// Whether the next correction of the ray need not be traced, because its result follows from
  /// derivatives. left: distance from Q that is expected to remain after this correction.
  bool ends_on_target(const Aim& aim, const Shot& shot, double left) const {
    if (!aim.precise || !(shot.miss <= options_.carry * gap_ && left <= options_.tolerance * gap_))
      return false;
    const double narrow = end_widths(aim, shot).narrow;
    return shot.miss <= 100 * options_.carry * narrow && left <= options_.same / 10 * narrow;
  }
  Shot carried(const Aim& aim, Shot shot, const Aim& next, double left) const {
    const double longer = next.sigma - aim.sigma, along = shot.error.dot(shot.end.v);
    shot.end.optical_path -= along;  // first-order change by Fermat's principle
    shot.end.arc_length -= along / shot.end.v.norm();
    shot.end.v += n_from_ * (shot.tangent.dv * (next.direction - aim.direction)) +
                  longer * ray_force(field_, shot.end.x).force;
    shot.end.x = to_;
    shot.error.setZero();
    shot.miss = left;
    return shot;
  }

  /// Whether the number of steps is steps_for(sigma). If sigma is a multiple of the step within
  /// rounding, two numbers of steps may alternate; the larger one is then kept.
  bool has_its_steps(const Aim& aim) const {
    const int steps = steps_for(aim.sigma);
    return steps == aim.steps || (aim.raised && steps < aim.steps);
  }

  /// Moves the end of the ray along the ray to the point closest to Q and returns the change of
  /// sigma. A ray with a new direction may pass closer to Q although it ends farther away. This
  /// happens at a focus, where rays of different directions have the same optical path but not the
  /// same sigma.
  double draw_near(Shot& shot, double sigma) const {
    const double wanted = -shot.error.dot(shot.end.v) / shot.end.v.squaredNorm();
    const double change = std::clamp(wanted, -sigma / 2, sigma / 2);
    Step::step(field_, shot.end, shot.tangent, change);
    shot.error = shot.end.x - to_;
    shot.miss = shot.error.norm();
    shot.uniform = false;
    return change;
  }

  /// Returns direction and length of the next ray, by a damped Gauss-Newton step. Near Q the number
  /// of steps is kept, because a change would move the end.
  Aim moved(const Aim& aim, const Shot& shot, DampedStep& damped) const {
    const CurveStart start =
        stepped({aim.direction, aim.sigma}, n_from_, shot.end, shot.tangent, shot.error, damped);
    Aim next = aim;
    next.direction = start.direction;
    next.sigma = start.sigma;
    if (shot.miss > near * gap_) next.steps = steps_for(next.sigma);
    return next;
  }

  Result judge(const Aim& aim, const Shot& shot, ConnectionStatistics& statistics) const {
    if (!shot.inside) return {TrialOutcome::left_region, {}};
    if (shot.end.arc_length > options_.max_length) return {TrialOutcome::too_long, {}};
    const double narrow = end_widths(aim, shot).narrow;
    if (shot.miss > options_.same / 10 * narrow ||
        (narrow < suspicious * shot.end.arc_length &&
         narrow < options_.caustic * follow(aim, statistics).widest()))
      return {TrialOutcome::degenerate, {}};
    const double spreading = signed_spreading(shot.tangent, n_from_, aim.direction, shot.end.v);
    return {TrialOutcome::converged,
            {aim.direction, shot.end.v.normalized(), aim.sigma, shot.end.arc_length,
             shot.end.optical_path, std::abs(spreading), spreading < 0 ? -1 : 1, aim.steps}};
  }

  /// Returns the outcome of a failed trial. If Q is at a focus, discretised rays miss it slightly,
  /// and no correction improves this.
  TrialOutcome judge_failure(const Aim& aim, const Shot& shot,
                             ConnectionStatistics& statistics) const {
    if (!(shot.miss < near * gap_)) return TrialOutcome::not_converged;
    const double narrowest = options_.caustic * follow(aim, statistics).widest();
    return shot.miss < narrowest && end_widths(aim, shot).narrow < narrowest
               ? TrialOutcome::degenerate
               : TrialOutcome::not_converged;
  }

  Widths end_widths(const Aim& aim, const Shot& shot) const {
    return widths(transverse_map(shot.tangent, n_from_, frame_across(aim.direction),
                                 frame_across(shot.end.v)));
  }

  const F& field_;
  R region_;
  Vec3 from_, to_;
  ConnectionOptions options_;
  double n_from_, gap_;
  double rounding_;  ///< rounding error of the coordinates in one integration step
};

}  // namespace flatspeckle::grin

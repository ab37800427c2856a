#include "grin/render/values/step_choice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "grin/media/scattering/start_directions.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/render/curved/ray_field.h"

namespace flatspeckle::grin {

namespace {

// numbers of rays of the pilot run that start at random, where the index is steepest, and at places
// listed by the field
constexpr std::size_t spread = 32, steep = 16, places = 16;
constexpr double longest_ray = 1000;  // longest ray of the pilot run, in units of the field's scale

const Surface& filled(const Stage& stage) {
  return stage.surface(stage.field_part());
}
double size(const Stage& stage) {
  const Box box = bounds(filled(stage));
  return (box.high - box.low).norm();
}

/// The field as given, and at further phases of the sound if light may meet any phase.
using FieldsMet = std::vector<std::unique_ptr<const RayField>>;
FieldsMet fields_met(const SceneField& field, bool any_phase, bool leapfrogs) {
  FieldsMet met;
  met.push_back(make_ray_field(field.field, {}, leapfrogs));
  if (any_phase)
    for (const double phase : {std::numbers::pi / 2, std::numbers::pi})
      met.push_back(met.front()->frozen(phase));
  return met;
}

/// Starts of the rays of the pilot run: at random, where the index is steepest, and at the critical
/// places listed by the field.
class PilotStarts {
 public:
  PilotStarts(const RayField& field, const SceneField& facts, const Surface& region)
      : region_(region), box_(bounds(region)) {
    constexpr std::size_t candidates = 512;
    while (points_.size() < candidates) points_.push_back(anywhere());
    const auto steepness = [&](const Vec3& x) { return field.gradient(x).gradient.squaredNorm(); };
    std::partial_sort(points_.begin() + spread, points_.begin() + spread + steep, points_.end(),
                      [&](const Vec3& a, const Vec3& b) { return steepness(a) > steepness(b); });
    points_.resize(spread + steep);
    for (const Vec3& place : facts.places) add(place);
    if (facts.symmetry == Symmetry::stratified)
      for (std::size_t i = 0; i < places && !facts.places.empty(); ++i) {
        const Vec3 x = anywhere();
        add(x - facts.axis * facts.axis.dot(x - facts.places.front()));
      }
  }
  const std::vector<Vec3>& points() const { return points_; }

  Vec3 direction() { return random_turn(Vec3::UnitZ(), 2 * random_.uniform(), random_); }

 private:
  Vec3 anywhere() {
    for (;;) {
      Vec3 share;
      for (const int axis : {2, 1, 0})
        share[axis] = random_.uniform();  // the chosen step depends on this order of random numbers
      const Vec3 x = box_.low + share.cwiseProduct(box_.high - box_.low);
      if (distance(region_, x) < 0) return x;
    }
  }
  void add(const Vec3& x) {
    if (points_.size() < spread + steep + places && distance(region_, x) < 0) points_.push_back(x);
  }

  const Surface& region_;
  Box box_;
  RandomStream random_{0, static_cast<std::uint64_t>(Stream::render), 0};
  std::vector<Vec3> points_;
};

/// A ray of the pilot run, of a given length in sigma, in one of the fields of FieldsMet.
class PilotRay {
 public:
  /// Determines the length of the ray to an accuracy of `stride`.
  PilotRay(const RayField& field, std::size_t met, const Surface& region, const RayState& start,
           double longest, double stride)
      : met_(met), start_(start) {
    RayState ray = start_;
    for (double long_stride = 4 * stride; long_stride >= stride;) {
      RayState next = ray;
      field.advance(long_stride, 1, next, nullptr);
      if (next.arc_length < longest && distance(region, next.x) <= 0) {
        ray = next;
        sigma_ += long_stride;
      } else {
        long_stride /= 4;
      }
    }
  }

  /// Returns the change of the ray when the step is halved, relative to the motion of its end when
  /// its start direction turns; NaN if there is no ray.
  double change_by_halving(const FieldsMet& fields, double step) const {
    const int steps = static_cast<int>(std::max(1.0, std::ceil(sigma_ / step)));
    const auto [coarse, coarse_tangent] = end(*fields[met_], steps);
    const auto [fine, fine_tangent] = end(*fields[met_], 2 * steps);
    const Frame from = frame_across(start_.v), to = frame_across(fine.v);
    const double n = start_.v.norm(), length = fine.arc_length;
    const Mat2 map = transverse_map(fine_tangent, n, from, to);
    const Mat2 moved = transverse_map(coarse_tangent, n, from, to) - map;
    const double reach = std::max(length, map.norm());
    return std::max({(coarse.x - fine.x).norm() / reach, moved.norm() / reach,
                     (coarse.v.normalized() - fine.v.normalized()).norm() * length / reach,
                     std::abs(coarse.optical_path - fine.optical_path) / fine.optical_path});
  }

 private:
  std::pair<RayState, RayTangent> end(const RayField& field, int steps) const {
    std::pair<RayState, RayTangent> ray{start_, {}};
    field.advance(sigma_, steps, ray.first, &ray.second);
    return ray;
  }

  std::size_t met_;
  RayState start_;
  double sigma_ = 0;
};

std::vector<PilotRay> pilot_rays(const FieldsMet& met, const SceneField& facts,
                                 const Stage& stage) {
  const double longest = std::min(size(stage), longest_ray * facts.scale);
  const double stride = std::min(size(stage), facts.scale) / 16;
  PilotStarts starts(*met.front(), facts, filled(stage));
  std::vector<PilotRay> rays;
  for (const Vec3& x : starts.points()) {
    const Vec3 direction = starts.direction();
    for (std::size_t i = 0; i < met.size(); ++i)
      rays.emplace_back(*met[i], i, filled(stage), start_ray(*met[i], x, direction), longest,
                        stride);
  }
  return rays;
}

double two_digits(double x) {
  const double parts = std::pow(10, 1 - std::floor(std::log10(x)));
  return std::floor(x * parts * (1 + 1e-9)) / parts;
}

}  // namespace

bool bends_nothing(const SceneField& field, const Stage& stage) {
  const double scales = size(stage) / field.scale;
  return !(field.scale > 0) || field.strength * scales * scales < step_tolerance / 10;
}

double longest_step(const SceneField& field, const Stage& stage) {
  if (bends_nothing(field, stage)) return size(stage);
  return std::min(size(stage), (field.places.empty() ? 3 : 1) * field.scale);
}

namespace {

/// A ray, and its change when the step was halved for the last time.
struct KnownChange {
  const PilotRay* ray;
  double change = 0;
};

/// Returns the longest step with which the errors of all rays are below step_tolerance, for one
/// integrator; 0 if that step is below `least`. Rays with the largest changes are tried first: a
/// single ray out of tolerance rules out a step.
double longest_good_step(const std::vector<PilotRay>& rays, const FieldsMet& met, int order,
                         double step, double least = 0) {
  constexpr int halvings = 8;
  const double seen =
      order == Leapfrog::order ? 0.75 : 1;  // fraction of the error that halving the step reveals
  std::vector<KnownChange> known;
  for (const PilotRay& ray : rays) known.push_back({&ray});
  for (int i = 0; i < halvings && step > least; ++i, step /= 2) {
    std::ranges::stable_sort(known, std::greater(), &KnownChange::change);
    double worst = 0;
    const auto finer = [&] { return std::pow(step_tolerance / worst, 1.0 / order); };
    for (auto& [ray, change] : known) {
      change = std::max(0.0, ray->change_by_halving(met, step) / seen);  // NaN becomes 0
      worst = std::max(worst, change);
      if (finer() < 0.5) break;
    }
    if (finer() >= 0.5) return two_digits(step * std::min(finer(), 1.0));
  }
  return step > least ? two_digits(step) : 0;
}

bool may_leap(const SceneField& field) {
  return std::visit([](const auto& of) { return goes_by_leapfrog<std::decay_t<decltype(of)>>; },
                    field.field);
}

StepChoice choice_of(const SceneField& field, const Stage& stage, bool any_phase, bool may_leap) {
  constexpr double cheaper = 2.2;  // Leapfrog evaluates one force per step instead of three
  const double longest = longest_step(field, stage);
  if (bends_nothing(field, stage)) return {longest};
  const FieldsMet met = fields_met(field, any_phase, false);
  const auto rays = pilot_rays(met, field, stage);
  const double step = longest_good_step(rays, met, Sharma::order, longest);
  if (!may_leap) return {step};
  const double leap = longest_good_step(rays, fields_met(field, any_phase, true), Leapfrog::order,
                                        longest, step / cheaper);
  return cheaper * leap > step ? StepChoice{leap, true} : StepChoice{step};
}

}  // namespace

double chosen_step(const SceneField& field, const Stage& stage, bool any_phase) {
  return choice_of(field, stage, any_phase, false).step;
}

StepChoice chosen_steps(const SceneField& field, const Stage& stage, bool any_phase) {
  return choice_of(field, stage, any_phase, may_leap(field));
}

}  // namespace flatspeckle::grin

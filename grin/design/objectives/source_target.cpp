#include "grin/design/objectives/source_target.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "grin/design/objectives/even_points.h"
#include "grin/design/objectives/solid_hull.h"
#include "grin/media/geometry/frame.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin::design {

namespace {

struct Sources {
  SolidHull hull;
  std::vector<Vec3> points;
  double half_angle;
  int rays_each;

  Vec3 axis(const Vec3& point) const { return (hull.centre - point).normalized(); }
  /// Returns the i-th of `count` rays from a source, which are distributed evenly over the cone's
  /// solid angle. A different `turn` gives other rays, which lie between the first ones.
  DesignRay ray(const Vec3& point, int i, int count, double turn) const {
    const Vec3 along = axis(point);
    const Eigen::Vector2d in_disk = even_point(i, count, turn);
    const double sine = std::sin(half_angle / 2) * in_disk.norm();  // sine of half the polar angle
    const Vec3 across = frame_across(along) * in_disk.normalized();
    const Vec3 direction =
        (1 - 2 * sine * sine) * along + 2 * sine * std::sqrt(1 - sine * sine) * across;
    const auto crossing = entry_and_exit(hull.surface, point, direction);
    if (!crossing)
      throw InputError("half_angle", half_angle,
                       "is too wide: light from " + listed(point) + " misses the field; reduce it");
    return {point + std::max(0.0, crossing->first) * direction, direction, hull.surface};
  }
  double rays() const { return static_cast<double>(points.size()) * rays_each; }
  int count(bool held_out) const { return held_out ? rays_each * 3 / 4 + 1 : rays_each; }
  void check(const Vec3& point) const {
    for (const bool held_out : {false, true})
      for (int i = 0; i < count(held_out); ++i) ray(point, i, count(held_out), held_out ? 0.5 : 0);
  }
};

/// Makes the rays of all sources and their objective. measure(axis) makes the measurement of a
/// source's rays; make_objective(number of measurements) makes the objective.
template <class Measured, class Measure, class Make>
DesignTask task_of(const Sources& sources, const RayWalk& walk, bool held_out,
                   const Measure& measure, const Make& make_objective) {
  const int count = sources.count(held_out);
  std::vector<DesignRay> rays;
  std::vector<Measured> measurements;
  for (const Vec3& point : sources.points)
    for (int i = 0; i < count; ++i) {
      rays.push_back(sources.ray(point, i, count, held_out ? 0.5 : 0));
      measurements.push_back(measure(sources.axis(point)));
    }
  auto objective = make_objective(2 * rays.size());
  return {make_ray_system(std::move(rays), std::move(measurements), walk), std::move(objective)};
}

class CollimationTarget : public DesignTarget {
 public:
  explicit CollimationTarget(Sources sources) : sources_(std::move(sources)) {}

  double rays() const override { return sources_.rays(); }
  DesignTask task(const RayWalk& walk, bool held_out) const override {
    return task_of<DirectionMeasurement>(
        sources_, walk, held_out,
        [](const Vec3& axis) { return DirectionMeasurement{frame_across(axis)}; },
        [](std::size_t count) { return make_target_objective(std::vector<double>(count, 0.0)); });
  }

 private:
  Sources sources_;
};

/// Objective that all rays should hit a disk centred at 0. Residuals are the vectors from the
/// disk's edge to the hits outside it, and 0 for hits inside.
class DiskObjective : public DesignObjective {
 public:
  DiskObjective(std::size_t measurements, double radius)
      : hits_(measurements / 2), radius_(radius) {}

  std::vector<double> residuals(std::span<const double> measurements) override {
    std::vector<double> all;
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      hits_[i] = {measurements[2 * i], measurements[2 * i + 1]};
      const Eigen::Vector2d beyond = part_beyond(hits_[i]) * hits_[i];
      all.insert(all.end(), {beyond[0], beyond[1]});
    }
    return all;
  }
  std::vector<double> times(std::span<const double> measurements) const override {
    std::vector<double> all;
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const Eigen::Vector2d change =
          derivative(hits_[i], {measurements[2 * i], measurements[2 * i + 1]});
      all.insert(all.end(), {change[0], change[1]});
    }
    return all;
  }
  /// Returns times(residuals), because the Jacobian is symmetric.
  std::vector<double> transposed(std::span<const double> residuals) const override {
    return times(residuals);
  }
  std::vector<double> weights() const override {
    return std::vector<double>(2 * hits_.size(), 1.0);
  }

 private:
  double part_beyond(const Eigen::Vector2d& hit) const {
    const double distance = hit.norm();
    return distance > radius_ ? 1 - radius_ / distance : 0;
  }
  Eigen::Vector2d derivative(const Eigen::Vector2d& hit, const Eigen::Vector2d& change) const {
    const double part = part_beyond(hit);
    if (part == 0) return Eigen::Vector2d::Zero();
    const Eigen::Vector2d outwards = hit.normalized();
    return part * change + (1 - part) * outwards * outwards.dot(change);
  }

  std::vector<Eigen::Vector2d> hits_;
  double radius_;
};

class ThroughputTarget : public DesignTarget {
 public:
  ThroughputTarget(Sources sources, double radius, double distance)
      : sources_(std::move(sources)), radius_(radius), distance_(distance) {}

  double rays() const override { return sources_.rays(); }
  DesignTask task(const RayWalk& walk, bool held_out) const override {
    return task_of<ScreenMeasurement>(
        sources_, walk, held_out,
        [&](const Vec3& axis) {
          return ScreenMeasurement{sources_.hull.centre + distance_ * axis, axis,
                                   frame_across(axis)};
        },
        [&](std::size_t count) { return std::make_unique<DiskObjective>(count, radius_); });
  }

 private:
  Sources sources_;
  double radius_, distance_;
};

void add_source_keys(Keys& keys, SourceValues& values) {
  keys.add("sources", values.sources,
           "x y z of each point source; the light is directed towards the centre of the field")
      .each_of(3, "a point")
      .unit("length");
  keys.add("half_angle", values.half_angle, "Half angle of the cone of light of each source")
      .positive_to(std::numbers::pi / 2)
      .unit("rad");
  keys.add("rays_per_source", values.rays_per_source,
           "Number of rays per source, distributed evenly over the cone")
      .from(1, 1'000'000);
}

Sources make_sources(const Keys& keys, const SourceValues& values, const FieldForm& form,
                     const char* goal) {
  Sources sources{solid_hull(form, goal),
                  {},
                  keys.read(values.half_angle),
                  static_cast<int>(keys.read(values.rays_per_source))};
  for (const auto point : parts_of(keys.required(values.sources), 3)) {
    sources.points.push_back(vector_of(point));
    if (distance(sources.hull.surface, sources.points.back()) < -1e-9 * sources.hull.radius)
      throw InputError("sources", listed(sources.points.back()), "must be outside the field");
    sources.check(sources.points.back());
  }
  return sources;
}

}  // namespace

void add_keys(Keys& keys, CollimationValues& values) {
  add_source_keys(keys, values);
}

void add_keys(Keys& keys, ThroughputValues& values) {
  add_source_keys(keys, values);
  keys.add("aperture_radius", values.aperture_radius,
           "Radius of the aperture that light should pass through")
      .positive()
      .unit("length");
  keys.add("aperture_distance", values.aperture_distance,
           "Distance of the aperture, which is behind the field, from the centre of the field "
           "(default: twice the radius)")
      .positive()
      .unit("length");
}

std::unique_ptr<DesignTarget> make_target(const Keys& keys, const CollimationValues& values,
                                          const FieldForm& form) {
  return std::make_unique<CollimationTarget>(
      make_sources(keys, values, form, CollimationValues::word));
}

std::unique_ptr<DesignTarget> make_target(const Keys& keys, const ThroughputValues& values,
                                          const FieldForm& form) {
  Sources sources = make_sources(keys, values, form, ThroughputValues::word);
  const double radius = keys.required(values.aperture_radius);
  const double far = keys.read(values.aperture_distance).value_or(2 * sources.hull.radius);
  const double least = std::sqrt(3.0) * sources.hull.radius;
  if (far < least)
    throw InputError(
        "aperture_distance", far,
        "must be at least " + std::to_string(least) + ", so that the aperture is behind the field");
  return std::make_unique<ThroughputTarget>(std::move(sources), radius, far);
}

}  // namespace flatspeckle::grin::design

#include "grin/design/goals/source_aim.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "grin/design/goals/even_points.h"
#include "grin/design/goals/solid_hull.h"
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
  /// Evenly over the cone's solid angle; of another turn rays between.
  DesignRay ray(const Vec3& point, int i, int count, double turn) const {
    const Vec3 along = axis(point);
    const Eigen::Vector2d in_disk = even_point(i, count, turn);
    const double sine = std::sin(half_angle / 2) * in_disk.norm();  // of half the angle
    const Vec3 across = frame_across(along) * in_disk.normalized();
    const Vec3 direction =
        (1 - 2 * sine * sine) * along + 2 * sine * std::sqrt(1 - sine * sine) * across;
    const auto way = passage(hull.surface, point, direction);
    if (!way)
      throw InputError("half_angle", half_angle,
                       "is too wide: light from " + listed(point) + " goes beside the field");
    return {point + std::max(0.0, way->first) * direction, direction, hull.surface};
  }
  double rays() const { return static_cast<double>(points.size()) * rays_each; }
  int count(bool held_out) const { return held_out ? rays_each * 3 / 4 + 1 : rays_each; }
  void check(const Vec3& point) const {
    for (const bool held_out : {false, true})
      for (int i = 0; i < count(held_out); ++i) ray(point, i, count(held_out), held_out ? 0.5 : 0);
  }
};

/// read(source, axis) makes the reading of a source's rays, goal(readings) what is asked of them.
template <class Reading, class Read, class Ask>
DesignTask task_of(const Sources& sources, const RayWalk& walk, bool held_out, const Read& read,
                   const Ask& ask) {
  const int count = sources.count(held_out);
  std::vector<DesignRay> rays;
  std::vector<Reading> readings;
  for (const Vec3& point : sources.points)
    for (int i = 0; i < count; ++i) {
      rays.push_back(sources.ray(point, i, count, held_out ? 0.5 : 0));
      readings.push_back(read(sources.axis(point)));
    }
  auto goal = ask(2 * rays.size());
  return {make_ray_system(std::move(rays), std::move(readings), walk), std::move(goal)};
}

class CollimationAim : public Aim {
 public:
  explicit CollimationAim(Sources sources) : sources_(std::move(sources)) {}

  double rays() const override { return sources_.rays(); }
  DesignTask task(const RayWalk& walk, bool held_out) const override {
    return task_of<DirectionReading>(
        sources_, walk, held_out,
        [](const Vec3& axis) { return DirectionReading{frame_across(axis)}; },
        [](std::size_t count) { return make_target_goal(std::vector<double>(count, 0.0)); });
  }

 private:
  Sources sources_;
};

/// How far rays are outside of a disk about 0.
class DiskGoal : public Goal {
 public:
  DiskGoal(std::size_t readings, double radius) : hits_(readings / 2), radius_(radius) {}

  std::vector<double> residuals(std::span<const double> readings) override {
    std::vector<double> all;
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      hits_[i] = {readings[2 * i], readings[2 * i + 1]};
      const Eigen::Vector2d beyond = part_beyond(hits_[i]) * hits_[i];
      all.insert(all.end(), {beyond[0], beyond[1]});
    }
    return all;
  }
  std::vector<double> times(std::span<const double> readings) const override {
    std::vector<double> all;
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const Eigen::Vector2d change = slope(hits_[i], {readings[2 * i], readings[2 * i + 1]});
      all.insert(all.end(), {change[0], change[1]});
    }
    return all;
  }
  /// The derivative is symmetric.
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
  Eigen::Vector2d slope(const Eigen::Vector2d& hit, const Eigen::Vector2d& change) const {
    const double part = part_beyond(hit);
    if (part == 0) return Eigen::Vector2d::Zero();
    const Eigen::Vector2d outwards = hit.normalized();
    return part * change + (1 - part) * outwards * outwards.dot(change);
  }

  std::vector<Eigen::Vector2d> hits_;
  double radius_;
};

class ThroughputAim : public Aim {
 public:
  ThroughputAim(Sources sources, double radius, double distance)
      : sources_(std::move(sources)), radius_(radius), distance_(distance) {}

  double rays() const override { return sources_.rays(); }
  DesignTask task(const RayWalk& walk, bool held_out) const override {
    return task_of<ScreenReading>(
        sources_, walk, held_out,
        [&](const Vec3& axis) {
          return ScreenReading{sources_.hull.centre + distance_ * axis, axis, frame_across(axis)};
        },
        [&](std::size_t count) { return std::make_unique<DiskGoal>(count, radius_); });
  }

 private:
  Sources sources_;
  double radius_, distance_;
};

void add_source_keys(Keys& keys, SourceValues& values) {
  keys.add("sources", values.sources, "x y z of each point that shines towards the centre")
      .each_of(3, "a point");
  keys.add("half_angle", values.half_angle, "Half of the angle of its cone of light")
      .positive_to(std::numbers::pi / 2)
      .unit("rad");
  keys.add("rays_per_source", values.rays_per_source, "Rays of each, evenly over the cone")
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
      throw InputError("sources", listed(sources.points.back()), "must be outside of the field");
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
  keys.add("aperture_radius", values.aperture_radius, "Of the disk that light is to pass through")
      .positive()
      .unit("length");
  keys.add("aperture_distance", values.aperture_distance,
           "Of that disk from the centre, beyond the field (default: twice the radius)")
      .positive()
      .unit("length");
}

std::unique_ptr<Aim> make_aim(const Keys& keys, const CollimationValues& values,
                              const FieldForm& form) {
  return std::make_unique<CollimationAim>(
      make_sources(keys, values, form, CollimationValues::word));
}

std::unique_ptr<Aim> make_aim(const Keys& keys, const ThroughputValues& values,
                              const FieldForm& form) {
  Sources sources = make_sources(keys, values, form, ThroughputValues::word);
  const double radius = keys.required(values.aperture_radius);
  const double far = keys.read(values.aperture_distance).value_or(2 * sources.hull.radius);
  const double least = std::sqrt(3.0) * sources.hull.radius;
  if (far < least)
    throw InputError("aperture_distance", far,
                     "must be at least " + std::to_string(least) + ", behind the field");
  return std::make_unique<ThroughputAim>(std::move(sources), radius, far);
}

}  // namespace flatspeckle::grin::design

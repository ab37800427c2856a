#include "grin/design/goals/deflection_aim.h"

#include <utility>

#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "grin/design/goals/solid_hull.h"

namespace flatspeckle::grin::design {

namespace {

struct MeasuredRay {
  Vec3 start, direction, behind;
};

/// Three columns of a file.
std::vector<Vec3> vectors(const ResultReader& file, const std::string& name) {
  std::vector<Vec3> all;
  for (int axis = 0; axis < 3; ++axis) {
    const auto values = file.dataset<double>(name + "xyz"[axis]);
    if (axis == 0) all.resize(values.size());
    if (values.size() != all.size())
      throw InputError("numbers in " + name + "xyz"[axis], values.size(),
                       "must be " + std::to_string(all.size()));
    for (std::size_t i = 0; i < values.size(); ++i) all[i][axis] = values[i];
  }
  return all;
}

std::vector<MeasuredRay> read_measured(const std::string& path) {
  return guarded_read(path, [&] {
    const ResultReader file(path);
    const auto start = vectors(file, "start/"), along = vectors(file, "start/d"),
               behind = vectors(file, "exit/d");
    if (along.size() != start.size() || behind.size() != start.size())
      throw InputError(path + ": start and exit must have as many rays");
    std::vector<MeasuredRay> rays;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const MeasuredRay ray{start[i], along[i], behind[i]};
      const double least = std::min(along[i].norm(), behind[i].norm());
      if (!(least > 0) || !start[i].allFinite() || !along[i].allFinite() || !behind[i].allFinite())
        throw InputError(path + ": ray " + std::to_string(i) + " has no direction or place");
      rays.push_back({ray.start, ray.direction.normalized(), ray.behind.normalized()});
    }
    return rays;
  });
}

class DeflectionAim : public Aim {
 public:
  DeflectionAim(const Surface& hull, std::vector<MeasuredRay> rays)
      : hull_(hull), measured_(std::move(rays)) {}

  double rays() const override { return 0.9 * static_cast<double>(measured_.size()); }

  DesignTask task(const RayWalk& walk, bool held_out) const override {
    constexpr std::size_t every = 10;
    std::vector<DesignRay> rays;
    std::vector<DirectionReading> readings;
    std::vector<double> targets;
    for (std::size_t i = 0; i < measured_.size(); ++i) {
      const auto& [start, along, behind] = measured_[i];
      if ((i % every == every / 2) != held_out) continue;
      const auto way = passage(hull_, start, along);
      rays.push_back({start + way->first * along, along, hull_});
      readings.push_back({frame_across(along)});
      const Eigen::Vector2d target = readings.back().frame.transpose() * behind;
      targets.insert(targets.end(), {target[0], target[1]});
    }
    return {make_ray_system(std::move(rays), std::move(readings), walk),
            make_target_goal(std::move(targets))};
  }

 private:
  Surface hull_;
  std::vector<MeasuredRay> measured_;
};

/// Those whose way through the field is long enough, and not along its face, to tell anything.
std::vector<MeasuredRay> through(const SolidHull& hull, const std::vector<MeasuredRay>& rays) {
  std::vector<MeasuredRay> through;
  for (const MeasuredRay& ray : rays) {
    const auto way = passage(hull.surface, ray.start, ray.direction);
    if (!way || way->second - way->first < 0.3 * hull.radius) continue;
    const Vec3 middle = ray.start + (way->first + way->second) / 2 * ray.direction;
    if (distance(hull.surface, middle) < -1e-3 * hull.radius) through.push_back(ray);
  }
  return through;
}

}  // namespace

void add_keys(Keys& keys, DeflectionValues& values) {
  keys.add("measured", values.measured,
           "Result of trace, or HDF5 with start/x y z, start/dx dy dz and exit/dx dy dz of rays: "
           "where they come from and their directions behind the field, in index 1")
      .file();
}

std::unique_ptr<Aim> make_aim(const Keys& keys, const DeflectionValues& values,
                              const FieldForm& form) {
  const SolidHull hull = solid_hull(form, DeflectionValues::word);
  auto rays = through(hull, read_measured(keys.required(values.measured)));
  if (rays.size() < 20)
    throw InputError(
        "measured", values.measured,
        "has " + std::to_string(rays.size()) + " rays through the field; must have at least 20");
  return std::make_unique<DeflectionAim>(hull.surface, std::move(rays));
}

}  // namespace flatspeckle::grin::design

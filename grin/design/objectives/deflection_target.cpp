#include "grin/design/objectives/deflection_target.h"

#include <utility>

#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "grin/design/objectives/solid_hull.h"

namespace flatspeckle::grin::design {

namespace {

struct MeasuredRay {
  Vec3 start, direction, behind;
};

/// Reads a dataset with three columns as vectors.
std::vector<Vec3> vectors(const ResultReader& file, const std::string& name) {
  std::vector<Vec3> all;
  for (int axis = 0; axis < 3; ++axis) {
    const auto values = file.dataset<double>(name + "xyz"[axis]);
    if (axis == 0) all.resize(values.size());
    if (values.size() != all.size())
      throw InputError(name + "xyz"[axis] + ": has " + std::to_string(values.size()) +
                       " numbers, must have " + std::to_string(all.size()));
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
      throw InputError(path + ": start and exit must have the same number of rays");
    std::vector<MeasuredRay> rays;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const MeasuredRay ray{start[i], along[i], behind[i]};
      const double least = std::min(along[i].norm(), behind[i].norm());
      if (!(least > 0) || !start[i].allFinite() || !along[i].allFinite() || !behind[i].allFinite())
        throw InputError(path + ": ray " + std::to_string(i) +
                         " must have a finite position and a direction that is not 0");
      rays.push_back({ray.start, ray.direction.normalized(), ray.behind.normalized()});
    }
    return rays;
  });
}

class DeflectionTarget : public DesignTarget {
 public:
  DeflectionTarget(const Surface& hull, std::vector<MeasuredRay> rays)
      : hull_(hull), measured_(std::move(rays)) {}

  double rays() const override { return 0.9 * static_cast<double>(measured_.size()); }

  DesignTask task(const RayWalk& walk, bool held_out) const override {
    constexpr std::size_t every = 10;
    std::vector<DesignRay> rays;
    std::vector<DirectionMeasurement> measurements;
    std::vector<double> targets;
    for (std::size_t i = 0; i < measured_.size(); ++i) {
      const auto& [start, along, behind] = measured_[i];
      if ((i % every == every / 2) != held_out) continue;
      const auto crossing = entry_and_exit(hull_, start, along);
      rays.push_back({start + crossing->first * along, along, hull_});
      measurements.push_back({frame_across(along)});
      const Eigen::Vector2d target = measurements.back().frame.transpose() * behind;
      targets.insert(targets.end(), {target[0], target[1]});
    }
    return {make_ray_system(std::move(rays), std::move(measurements), walk),
            make_target_objective(std::move(targets))};
  }

 private:
  Surface hull_;
  std::vector<MeasuredRay> measured_;
};

/// Returns the rays that constrain the index: those whose path through the field is long enough and
/// does not run along a face.
std::vector<MeasuredRay> through(const SolidHull& hull, const std::vector<MeasuredRay>& rays) {
  std::vector<MeasuredRay> through;
  for (const MeasuredRay& ray : rays) {
    const auto crossing = entry_and_exit(hull.surface, ray.start, ray.direction);
    if (!crossing || crossing->second - crossing->first < 0.3 * hull.radius) continue;
    const Vec3 middle = ray.start + (crossing->first + crossing->second) / 2 * ray.direction;
    if (distance(hull.surface, middle) < -1e-3 * hull.radius) through.push_back(ray);
  }
  return through;
}

}  // namespace

void add_keys(Keys& keys, DeflectionValues& values) {
  keys.add("measured", values.measured,
           "Result of trace, or HDF5 file with start/x y z, start/dx dy dz and exit/dx dy dz of "
           "rays: start points, directions at the start, and directions behind the field (index 1)")
      .file();
}

std::unique_ptr<DesignTarget> make_target(const Keys& keys, const DeflectionValues& values,
                                          const FieldForm& form) {
  const SolidHull hull = solid_hull(form, DeflectionValues::word);
  auto rays = through(hull, read_measured(keys.required(values.measured)));
  if (rays.size() < 20)
    throw InputError(
        "measured", values.measured,
        "has " + std::to_string(rays.size()) + " rays through the field; must have at least 20");
  return std::make_unique<DeflectionTarget>(hull.surface, std::move(rays));
}

}  // namespace flatspeckle::grin::design

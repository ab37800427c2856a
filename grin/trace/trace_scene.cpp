#include "grin/trace/trace_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/keys/number_text.h"
#include "core/numbers/address_space.h"
#include "core/numbers/symmetric.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/render/curved/ray_field.h"

namespace flatspeckle::grin {

namespace {

using Vec = Eigen::Vector2d;

/// Returns two perpendicular axes in the plane: x and y for a plane normal to z, otherwise axes
/// close to these two.
Eigen::Matrix<double, 3, 2> axes_across(const Vec3& normal) {
  const Vec3 guide = std::abs(normal[0]) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 first = (guide - normal * normal.dot(guide)).normalized();
  Eigen::Matrix<double, 3, 2> axes;
  axes << first, normal.cross(first);
  return axes;
}

std::vector<std::uint64_t> rays_to_show(const std::vector<TracedRay>& rays) {
  std::vector<std::uint64_t> all, stopped;
  for (std::uint64_t i = 0; i < rays.size(); ++i) {
    if (rays[i].status != RayStatus::absorbed) all.push_back(i);
    if (rays[i].status == RayStatus::surface) stopped.push_back(i);
  }
  return stopped.empty() ? all : stopped;
}

/// Returns the distance from a ray's end to the plane, along the ray's direction. Throws InputError
/// if the index varies at the ray's end or the ray is parallel to the plane.
double length_to(const Plane& plane, const TracedRay& ray, std::uint64_t number) {
  const Vec3 direction = ray.end.v.normalized();
  const double speed = plane.outwards.dot(direction);
  const auto refuse = [&](const std::string& why) {
    throw InputError("image_plane: ray " + std::to_string(number) + ' ' + why);
  };
  if (!(std::abs(speed) > 1e-6)) refuse("is parallel to the plane: give another normal");
  const double distance_to_plane = -plane.distance(ray.end.x) / speed;
  if (ray.end_derivative * std::abs(distance_to_plane) > 1e-9)
    refuse(
        "ends where the index varies and cannot be extended straight to the plane: let it end in a "
        "homogeneous region (stop_plane)");
  return distance_to_plane;
}

Vec mean(const RayImage& image, Vec RayImage::Ray::*value) {
  Vec sum = Vec::Zero();
  for (const auto& ray : image.rays) sum += ray.*value;
  return sum / static_cast<double>(image.rays.size());
}

/// Returns the distance along the normal to the smallest spot, where the mean square distance from
/// the centroid is least; nullopt for parallel rays.
std::optional<double> focus_of(const RayImage& image) {
  const Vec at = mean(image, &RayImage::Ray::at), slope = mean(image, &RayImage::Ray::slope);
  double both = 0, square = 0;
  for (const auto& ray : image.rays) {
    both += (ray.at - at).dot(ray.slope - slope);
    square += (ray.slope - slope).squaredNorm();
  }
  if (!(square > 1e-18 * static_cast<double>(image.rays.size()))) return std::nullopt;
  return -both / square;
}

void measure_spot(RayImage& image) {
  const Vec middle = mean(image, &RayImage::Ray::at);
  double square = 0;
  for (const auto& ray : image.rays) {
    const double apart = (ray.at - middle).squaredNorm();
    square += apart / static_cast<double>(image.rays.size());
    image.spot_extent = std::max(image.spot_extent, std::sqrt(apart));
  }
  image.spot_radius = std::sqrt(square);
}

/// Difference between the optical path of a ray to the foot of the perpendicular from a point and
/// the mean over all rays, and its derivative with respect to the point.
struct PathDifference {
  double path;
  Vec3 direction;  ///< derivative with respect to the point: direction times index, minus the mean
                   ///< over all rays
};
std::vector<PathDifference> path_differences(const RayImage& image,
                                             const std::vector<TracedRay>& rays,
                                             const Vec3& point) {
  std::vector<PathDifference> found;
  PathDifference mean{0, Vec3::Zero()};
  for (const auto& ray : image.rays) {
    const RayState& end = rays[ray.number].end;
    found.push_back({end.optical_path + end.v.dot(point - end.x), end.v});
    mean.path += found.back().path / static_cast<double>(image.rays.size());
    mean.direction += found.back().direction / static_cast<double>(image.rays.size());
  }
  for (PathDifference& one : found) one = {one.path - mean.path, one.direction - mean.direction};
  return found;
}

/// Returns the shift of the reference point that minimises the mean square path difference. It has
/// no component along directions in which the path differences do not change, for example
/// perpendicular to the plane of a flat bundle.
Vec3 least_shift(const std::vector<PathDifference>& differences) {
  Mat3 square = Mat3::Zero();
  Vec3 along = Vec3::Zero();
  for (const PathDifference& one : differences) {
    square += one.direction * one.direction.transpose();
    along -= one.path * one.direction;
  }
  const auto [squares, axes] = symmetric_eigen(square);
  Vec3 shift = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = axes.col(i);
    if (squares[i] > 1e-13 * squares[2]) shift += axis * (axis.dot(along) / squares[i]);
  }
  return shift;
}

void measure_paths(RayImage& image, const std::vector<TracedRay>& rays, const Plane& plane) {
  const Vec3 point = plane.point + image.axes * mean(image, &RayImage::Ray::at);
  const auto differences = path_differences(image, rays, point);
  const Vec3 shift = image.focus ? least_shift(differences) : Vec3(Vec3::Zero());
  if (image.focus) image.best_point = point + shift;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const auto& [path, direction] = differences[i];
    image.rays[i].path_difference = path;
    image.rays[i].least_path_difference = path + direction.dot(shift);
  }
}

void check_index(const std::vector<TracedRay>& rays, const std::vector<std::uint64_t>& numbers) {
  const auto index = [&](std::uint64_t i) { return rays[i].end.v.norm(); };
  const auto [least, most] = std::ranges::minmax(numbers, {}, index);
  if (index(most) - index(least) > 1e-9 * index(most))
    throw InputError("image_plane: rays end at different indices, from " +
                     std::to_string(index(least)) + " to " + std::to_string(index(most)));
}

/// For each surface, the side on which both end points P and Q of the searched curves lie. A point
/// on a surface counts as lying on both sides.
class SameSides {
 public:
  SameSides(const SceneField& scene, const RayStops& stops, const CurveSearch& search)
      : surfaces_(stops.surfaces), location_(stops.location) {
    for (const auto& surface : surfaces_)
      signs_.push_back(common_side(surface, search.from, search.to));
    if (search.ball) keep_inside(*search.ball, search, "the ball");
    if (scene.grid) keep_inside(*scene.grid, search, "the grid");
  }

  Sides region() const { return {surfaces_, signs_, location_}; }

  /// Whether the curve crosses no surface. This also detects crossings between the steps at which
  /// the search checks the region.
  bool holds(const RayField& field, const Vec3& from, const Connection& curve) const {
    const RaySteps steps{Sharma(), curve.sigma / curve.steps};
    RayLog log(steps, false);
    RayState ray = start_ray(field, from, curve.start_direction);
    field.follow(surfaces_, {curve.arc_length, location_}, log, ray);
    // The end of the curve may lie on a surface
    return ray.arc_length > (1 - 1e-6) * curve.arc_length;
  }

 private:
  /// Returns 1 if both points lie inside the surface, -1 if both lie outside. Throws InputError
  /// otherwise.
  double common_side(const Surface& surface, const Vec3& from, const Vec3& to) const {
    const double a = distance(surface, from), b = distance(surface, to);
    if (a <= location_ && b <= location_) return 1;
    if (std::holds_alternative<Plane>(surface))
      throw InputError("connect", listed(a > location_ ? from : to),
                       "lies behind a stop_plane: move the point or the plane");
    if (a >= -location_ && b >= -location_) return -1;
    throw InputError("connect", listed(from) + ' ' + listed(to),
                     "lie on different sides of a stop surface; must lie on the same side");
  }

  void keep_inside(const Surface& surface, const CurveSearch& search, const std::string& what) {
    for (const Vec3& x : {search.from, search.to})
      if (distance(surface, x) > location_)
        throw InputError("connect", listed(x), "must lie inside " + what);
    surfaces_.push_back(surface);
    signs_.push_back(1);
  }

  std::vector<Surface> surfaces_;
  std::vector<double> signs_;
  double location_;
};

/// Removes the curves for which holds(curve) is false; the trials that found them are counted as
/// having left the region.
template <class Holds>
void sort_out(FoundConnections& found, const Holds& holds) {
  auto& outcomes = found.statistics.outcomes;
  auto& converged = outcomes[static_cast<int>(TrialOutcome::converged)];
  std::erase_if(found.curves, [&](const FoundConnection& one) {
    if (holds(one.curve)) return false;
    const auto trials = std::min(converged, one.found);  // a homogeneous field needs no trials
    converged -= trials;
    outcomes[static_cast<int>(TrialOutcome::left_region)] += trials;
    return true;
  });
}

/// Throws InputError if the rays do not fit into memory. Each ray needs a start, an end and result
/// columns; each path point is stored twice, in its ray and in result columns.
void check_memory(const TraceValues& values) {
  if (!values.starts.rays.empty()) return;
  constexpr double ray = 600, point = 2 * sizeof(Vec3);
  const double points = static_cast<double>(values.path_points);
  const double bytes = static_cast<double>(values.starts.ray_count) * (ray + point * points);
  const double memory = usable_memory();
  if (bytes > 0.8 * memory)
    throw InputError("ray_count", values.starts.ray_count,
                     "with path_points = " + std::to_string(values.path_points) + " needs " +
                         std::to_string(bytes / 1e9) +
                         " GB of memory; available: " + std::to_string(memory / 1e9));
}

/// Returns the start points of the rays or, in a search for curves, their two end points.
std::vector<Vec3> points_of(const TraceScene& scene) {
  if (scene.curves) return {scene.curves->from, scene.curves->to};
  std::vector<Vec3> points;
  for (const RayStart& start : scene.starts) points.push_back(start.x);
  return points;
}

std::vector<Surface> surfaces_of(const Stage& stage) {
  std::vector<Surface> surfaces;
  for (const Body& body : stage.bodies) surfaces.push_back(body.surface);
  return surfaces;
}

/// Returns the search for curves between the two points of the key `connect`; nullopt if this key
/// is not given.
std::optional<CurveSearch> make_curve_search(const Keys& keys, const CurveValues& values) {
  const auto& ends = keys.read(values.connect);
  if (ends.empty()) return std::nullopt;
  const CurveSearch search{vector_of(ends), vector_of(ends, 3),
                           static_cast<std::uint64_t>(keys.read(values.trials))};
  if ((search.to - search.from).norm() <= 1e-10 * std::max(search.from.norm(), search.to.norm()))
    throw InputError("connect", number_text(ends), "must be two different points");
  return search;
}

/// Returns the largest index on the straight line between the end points; 1 if the line lies
/// outside the field.
double largest_index(const SceneField& scene, const CurveSearch& search) {
  constexpr int points = 101;
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const Vec3 x = search.from + i / (points - 1.0) * (search.to - search.from);
    largest = std::max(largest, index_at(scene, x));
  }
  return largest > 0 ? largest : 1;
}

/// Returns the beam of a light of parallel rays; nullopt for other lights.
std::optional<ParallelBeam> parallel_beam(const RayStartValues& values) {
  const bool is_parallel = values.light != "fan" && values.light != "cone";
  if (!values.rays.empty() || !is_parallel) return std::nullopt;
  return ParallelBeam{vector_of(values.origin), vector_of(values.direction).normalized(),
                      values.beam_radius};
}

void settle_field(TraceScene& scene, const Keys& keys, const TraceValues& values) {
  double reach = keys.required(values.stops.max_length), farthest = 0;
  for (const Vec3& x : points_of(scene)) {
    reach = std::max(reach, std::hypot(x[0], x[1]));
    farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
  }
  scene.field = make_scene_field(keys, values.field,
                                 {.reach = reach, .length_unit = keys.read(values.length_unit)});
  if (scene.curves)
    scene.curves->ball = std::exchange(scene.field.rim, std::nullopt);
  else
    scene.stage = make_ray_stage(keys, values.bodies, scene.field, keys.read(values.length_unit));
  scene.stops =
      make_ray_stops(keys, values.stops, scene.field.scale, farthest, surfaces_of(scene.stage));
  check_bodies(scene.stage);
}

/// Sets the integration steps. The default step of curves is shorter than the default step of rays.
void settle_steps(TraceScene& scene, const Keys& keys, const TraceValues& values) {
  if (!scene.curves) {
    scene.steps = make_ray_steps(keys, values.stops, scene.field.scale);
    return;
  }
  double step = curve_step(keys, values.stops, scene.field.scale / 100);
  if (!values.stops.step) step /= largest_index(scene.field, *scene.curves);
  scene.steps = {Sharma(), step};
}

}  // namespace

void add_keys(Keys& keys, RayImageValues& values) {
  keys.group("Image of rays");
  keys.add("image_plane", values.image_plane,
           "x y z nx ny nz: plane on which spot, ray slopes and optical path differences are "
           "measured; rays are extended to it along straight lines, forward or backward")
      .exactly(6, "a point and a normal")
      .units("length length length 1 1 1");
  keys.add("refocus", values.refocus, "Move the plane along its normal to the smallest spot")
      .only_of("image_plane");
}

std::optional<ImagePlane> make_image_plane(const Keys& keys, const RayImageValues& values) {
  const auto& numbers = keys.read(values.image_plane);
  if (numbers.empty()) return std::nullopt;
  const Vec3 normal = unit_direction("image_plane, normal", vector_of(numbers, 3));
  return ImagePlane{{vector_of(numbers), normal}, keys.read(values.refocus)};
}

RayImage make_ray_image(const ImagePlane& requested, const std::vector<TracedRay>& rays) {
  Plane plane = requested.plane;
  RayImage image;
  image.axes = axes_across(plane.outwards);
  const auto numbers = rays_to_show(rays);
  if (numbers.empty()) throw InputError("image_plane: all rays are absorbed");
  check_index(rays, numbers);
  for (const std::uint64_t number : numbers) {
    const RayState& end = rays[number].end;
    const Vec3 direction = end.v.normalized();
    const Vec3 at = end.x + length_to(plane, rays[number], number) * direction;
    image.rays.push_back({number, image.axes.transpose() * (at - plane.point),
                          image.axes.transpose() * direction / plane.outwards.dot(direction), 0,
                          0});
  }
  image.focus = focus_of(image);
  if (requested.refocus) {
    if (!image.focus)
      throw InputError(
          "refocus = true: the rays are parallel and have no focus; leave refocus out");
    image.distance = *image.focus;
    plane.point += image.distance * plane.outwards;
    for (auto& ray : image.rays) ray.at += image.distance * ray.slope;
  }
  measure_spot(image);
  measure_paths(image, rays, plane);
  return image;
}

double root_mean_square(const RayImage& image, double RayImage::Ray::*difference) {
  double square = 0;
  for (const auto& ray : image.rays)
    square += ray.*difference * (ray.*difference) / static_cast<double>(image.rays.size());
  return std::sqrt(square);
}

void add_keys(Keys& keys, CurveValues& values) {
  keys.group("Curves");
  keys.add("connect", values.connect,
           "x y z x y z: find the ray curves from the first point to the second, instead of "
           "tracing rays")
      .exactly(6, "six numbers x y z x y z")
      .unit("length");
  keys.add("trials", values.trials, "Number of random starts in the search for curves")
      .positive()
      .only_of("connect");
}

void add_keys(Keys& keys, TraceValues& values) {
  add_keys(keys, values.field);
  add_keys(keys, values.bodies);
  add_keys(keys, values.starts);
  add_keys(keys, values.curves);
  add_keys(keys, values.stops);
  add_keys(keys, values.image);
  keys.group("Result");
  keys.add("path_points", values.path_points,
           "Number of points of each ray stored for plots, together with an index map; 0 stores "
           "none")
      .from(0, 100'000);
  keys.add("length_unit", values.length_unit,
           "Unit of length in metres, for example um or 1e-6; used for times of flight")
      .positive()
      .unit("m");
}

TraceScene make_trace_scene(const Keys& keys, const TraceValues& values) {
  TraceScene scene;
  scene.length_unit = keys.read(values.length_unit);
  scene.path_points = static_cast<std::size_t>(keys.read(values.path_points));
  if (scene.path_points == 1)
    throw InputError("path_points", 1, "must be 0 or at least 2, for the first and the last point");
  scene.curves = make_curve_search(keys, values.curves);
  if (!scene.curves) {
    check_memory(values);
    scene.starts = make_ray_starts(keys, values.starts);
    scene.apertures = make_apertures(keys, values.bodies);
    scene.image = make_image_plane(keys, values.image);
    scene.beam = parallel_beam(values.starts);
    if (scene.image) scene.wavelength = keys.read(values.bodies.plain_bodies.wavelength);
  }
  settle_field(scene, keys, values);
  settle_steps(scene, keys, values);
  return scene;
}

TraceScene make_trace_scene(const TraceValues& values) {
  return made_of(
      values, [](const Keys& keys, const TraceValues& all) { return make_trace_scene(keys, all); });
}

std::vector<TracedRay> trace_rays(const TraceScene& scene) {
  return trace_rays(scene.field, scene.stage, scene.stops, scene.steps, scene.starts,
                    scene.path_points, scene.apertures);
}

FoundConnections find_connections(const TraceScene& scene, std::uint64_t seed) {
  const CurveSearch& search = *scene.curves;
  const SameSides sides(scene.field, scene.stops, search);
  const auto field = make_ray_field(scene.field.field);
  for (const Vec3& x : {search.from, search.to})
    if (!(index(*field, x) > 0))
      throw InputError("connect", listed(x), "must lie where the index of the field is above 0");
  RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), 0);
  FoundConnections found;
  found.curves =
      field->connections({search.from, search.to, sides.region()},
                         {.step = scene.steps.longest, .max_length = scene.stops.max_length},
                         search.trials, random, found.statistics);
  sort_out(found, [&](const auto& curve) { return sides.holds(*field, search.from, curve); });
  return found;
}

std::vector<TracedRay> rays_along(const TraceScene& scene, const FoundConnections& found) {
  std::vector<TracedRay> rays;
  for (const auto& [curve, times] : found.curves) {
    const RayStops stops{{}, curve.arc_length, 1e-12 * curve.arc_length};
    const RayStart start{scene.curves->from, curve.start_direction};
    rays.push_back(
        trace_rays(scene.field, scene.stage, stops, scene.steps, {start}, scene.path_points)[0]);
  }
  return rays;
}

}  // namespace flatspeckle::grin

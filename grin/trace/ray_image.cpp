#include "grin/trace/ray_image.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

namespace {

using Vec2 = Eigen::Vector2d;

/// x and y of a plane across z; else as near to them as can be.
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
    all.push_back(i);
    if (rays[i].status == RayStatus::surface) stopped.push_back(i);
  }
  return stopped.empty() ? all : stopped;
}

/// To the plane, along a ray's direction; where it is not straight, or never meets it, refused.
double way_to(const Plane& plane, const TracedRay& ray, std::uint64_t number) {
  const Vec3 direction = ray.end.v.normalized();
  const double speed = plane.outwards.dot(direction);
  const auto refuse = [&](const std::string& why) {
    throw InputError("image_plane: ray " + std::to_string(number) + ' ' + why);
  };
  if (!(std::abs(speed) > 1e-6)) refuse("runs along the plane");
  const double way = -plane.distance(ray.end.x) / speed;
  if (ray.end_slope * std::abs(way) > 1e-9)
    refuse("ends where the index varies, and goes straight to the plane only where it does not");
  return way;
}

Vec2 mean(const RayImage& image, Vec2 RayImage::Ray::*value) {
  Vec2 sum = Vec2::Zero();
  for (const auto& ray : image.rays) sum += ray.*value;
  return sum / static_cast<double>(image.rays.size());
}

/// By least squares of the distances from the mean.
std::optional<double> focus_of(const RayImage& image) {
  const Vec2 at = mean(image, &RayImage::Ray::at), slope = mean(image, &RayImage::Ray::slope);
  double both = 0, square = 0;
  for (const auto& ray : image.rays) {
    both += (ray.at - at).dot(ray.slope - slope);
    square += (ray.slope - slope).squaredNorm();
  }
  if (!(square > 1e-18 * static_cast<double>(image.rays.size()))) return std::nullopt;
  return -both / square;
}

void measure_spot(RayImage& image) {
  const Vec2 middle = mean(image, &RayImage::Ray::at);
  double square = 0;
  for (const auto& ray : image.rays) {
    const double apart = (ray.at - middle).squaredNorm();
    square += apart / static_cast<double>(image.rays.size());
    image.spot_extent = std::max(image.spot_extent, std::sqrt(apart));
  }
  image.spot_radius = std::sqrt(square);
}

/// How the path of a ray to the foot of the perpendicular from a point differs from the mean of
/// all, and how that changes with the point.
struct PathDifference {
  double path;
  Vec3 direction;  ///< times the index
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

/// Of the point, by which their mean square becomes least. Where nothing depends on a direction, as
/// of rays in a plane, none along it.
Vec3 least_shift(const std::vector<PathDifference>& differences) {
  Mat3 square = Mat3::Zero();
  Vec3 along = Vec3::Zero();
  for (const PathDifference& one : differences) {
    square += one.direction * one.direction.transpose();
    along -= one.path * one.direction;
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(square);
  Vec3 shift = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = axes.eigenvectors().col(i);
    if (axes.eigenvalues()[i] > 1e-13 * axes.eigenvalues()[2])
      shift += axis * (axis.dot(along) / axes.eigenvalues()[i]);
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

}  // namespace

void add_keys(Keys& keys, RayImageValues& values) {
  keys.group("Image of rays");
  keys.add(
          "image_plane", values.image_plane,
          "x y z nx ny nz: spot, slopes and optical path differences of the rays on this plane, to "
          "which they go straight on from where they end, or back")
      .exactly(6, "a point and a normal");
  keys.add("refocus", values.refocus, "The plane moves along its normal to where the spot is least")
      .only_of("image_plane");
}

std::optional<ImagePlane> make_image_plane(const Keys& keys, const RayImageValues& values) {
  const auto& numbers = keys.read(values.image_plane);
  if (numbers.empty()) return std::nullopt;
  const Vec3 normal = unit_direction("image_plane, normal", vector_of(numbers, 3));
  return ImagePlane{{vector_of(numbers), normal}, keys.read(values.refocus)};
}

RayImage make_ray_image(const ImagePlane& asked, const std::vector<TracedRay>& rays) {
  Plane plane = asked.plane;
  RayImage image;
  image.axes = axes_across(plane.outwards);
  const auto numbers = rays_to_show(rays);
  check_index(rays, numbers);
  for (const std::uint64_t number : numbers) {
    const RayState& end = rays[number].end;
    const Vec3 direction = end.v.normalized();
    const Vec3 at = end.x + way_to(plane, rays[number], number) * direction;
    image.rays.push_back({number, image.axes.transpose() * (at - plane.point),
                          image.axes.transpose() * direction / plane.outwards.dot(direction), 0,
                          0});
  }
  image.focus = focus_of(image);
  if (asked.refocus) {
    if (!image.focus) throw InputError("refocus: the rays are parallel, and meet nowhere");
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

}  // namespace flatspeckle::grin

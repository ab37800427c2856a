#pragma once

#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "grin/trace/ray_tracing.h"

namespace flatspeckle::grin {

/// A plane at which the image of rays is looked at, as keys have it.
struct RayImageValues {
  std::vector<double> image_plane{};
  bool refocus = false;
};

void add_keys(Keys& keys, RayImageValues& values);

struct ImagePlane {
  Plane plane;
  bool refocus;  ///< moved along its normal to where the spot is least
};

/// Nothing where none is asked for. Throws InputError.
std::optional<ImagePlane> make_image_plane(const Keys& keys, const RayImageValues& values);

/// Rays that end on a stop surface (all where none does), gone straight on to the plane from there,
/// or back. Positions and slopes in the plane are along `axes`, from the plane's point.
///
/// Optical path differences are those at a sphere far away about a point P: the path of a ray to
/// the foot of the perpendicular from P, less the mean of that of all rays. It is linear in P, so
/// that the P of the least mean square is found by least squares.
struct RayImage {
  struct Ray {
    std::uint64_t number;
    Eigen::Vector2d at, slope;
    double path_difference, least_path_difference;  ///< about the spot's mean; about best_point
  };
  std::vector<Ray> rays;
  Eigen::Matrix<double, 3, 2> axes;
  double distance = 0;             ///< of the plane from that asked for
  std::optional<double> focus;     ///< where the spot is least; nothing for parallel rays
  std::optional<Vec3> best_point;  ///< likewise
  double spot_radius = 0;          ///< root mean square distance from the mean
  double spot_extent = 0;          ///< largest
};

/// Throws InputError for rays along the plane, or that end where the index is not even.
RayImage make_ray_image(const ImagePlane& image, const std::vector<TracedRay>& rays);

/// Of path differences.
double root_mean_square(const RayImage& image, double RayImage::Ray::*difference);

}  // namespace flatspeckle::grin

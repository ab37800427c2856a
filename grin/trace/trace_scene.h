#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "grin/media/fields/scene_field.h"
#include "grin/rays/connections/connection.h"
#include "grin/rays/marching/ray_stops.h"
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

/// The curves between two points as keys have them.
struct CurveValues {
  std::vector<double> connect{};
  std::int64_t trials = 1000;
};

void add_keys(Keys& keys, CurveValues& values);

struct CurveSearch {
  Vec3 from, to;
  std::uint64_t trials;
  std::optional<Sphere> ball = {};  ///< that curves stay in: a field's rim
};

struct FoundConnections {
  std::vector<FoundConnection> curves;  ///< by optical path
  ConnectionStatistics statistics;
};

/// Rays through an index field, or the curves between two points of it, as keys have them.
struct TraceValues {
  IndexFieldValues field{};
  RayBodyValues bodies{};
  RayStartValues starts{};
  RayStopValues stops{};
  RayImageValues image{};
  CurveValues curves{};
  std::int64_t path_points = 0;
  double length_unit = 1;
};

void add_keys(Keys& keys, TraceValues& values);

struct TraceScene {
  SceneField field;
  Stage stage;  ///< of the bodies; its boundary stops nothing
  RayStops stops;
  RaySteps steps;
  std::vector<RayStart> starts = {};  ///< none where curves are sought
  std::optional<CurveSearch> curves = {};
  std::optional<ImagePlane> image = {};  ///< of rays
  std::size_t path_points = 0;           ///< of each ray or curve; 0: none
  double length_unit = 1;                ///< metres in a unit of length
};

/// Both throw InputError; of values alone, all must be of use.
TraceScene make_trace_scene(const Keys& keys, const TraceValues& values);
TraceScene make_trace_scene(const TraceValues& values);

std::vector<TracedRay> trace_rays(const TraceScene& scene);

/// Curves that stay on the side of every stop surface, and within the ball or grid, that both
/// points are on. Throws InputError.
FoundConnections find_connections(const TraceScene& scene, std::uint64_t seed);
/// Each curve as a ray of its length, for its points.
std::vector<TracedRay> rays_along(const TraceScene& scene, const FoundConnections& found);

}  // namespace flatspeckle::grin

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

/// Scene keys of the plane on which the spot of the rays is measured.
struct RayImageValues {
  std::vector<double> image_plane{};
  bool refocus = false;
};

void add_keys(Keys& keys, RayImageValues& values);

struct ImagePlane {
  Plane plane;
  bool refocus;  ///< whether the plane moves along its normal to the smallest spot
};

/// Returns the plane on which the spot is measured; nullopt if the key image_plane is not given.
/// Throws InputError.
std::optional<ImagePlane> make_image_plane(const Keys& keys, const RayImageValues& values);

/// Intersections of rays with a plane. The rays that end on a stop surface (all rays if none does)
/// are extended straight to the plane, forward or backward. Positions and slopes in the plane are
/// components along `axes`, relative to the plane's point. Optical path differences refer to a
/// distant reference sphere about a point P: the optical path of a ray to the foot of the
/// perpendicular from P, minus the mean over all rays. The differences are linear in P, so that
/// linear least squares gives the point P for which their mean square is smallest.
struct RayImage {
  struct Ray {
    std::uint64_t number;
    Eigen::Vector2d at, slope;
    /// Optical path differences if P is the centroid of the spot, and if P is best_point.
    double path_difference, least_path_difference;
  };
  std::vector<Ray> rays;
  Eigen::Matrix<double, 3, 2> axes;
  /// Distance of this plane from the plane given by the key, along the normal.
  double distance = 0;
  /// Distance along the normal from the plane of the key image_plane to the smallest spot; nullopt
  /// for parallel rays.
  std::optional<double> focus;
  /// Point P with the smallest mean square path difference; nullopt for parallel rays.
  std::optional<Vec3> best_point;
  double spot_radius = 0;  ///< root mean square distance of the rays from their centroid
  double spot_extent = 0;  ///< largest distance of a ray from the centroid
};

/// Computes the intersections of rays with a plane. Throws InputError for rays parallel to the
/// plane and for rays that end where the index varies.
RayImage make_ray_image(const ImagePlane& image, const std::vector<TracedRay>& rays);

/// Returns the root mean square over the rays of the given member, one of the two path differences.
double root_mean_square(const RayImage& image, double RayImage::Ray::*difference);

/// Scene keys of the search for ray curves between two points.
struct CurveValues {
  std::vector<double> connect{};
  std::int64_t trials = 1000;
};

void add_keys(Keys& keys, CurveValues& values);

struct CurveSearch {
  Vec3 from, to;
  std::uint64_t trials;
  std::optional<Sphere> ball = {};  ///< rim of the field, inside which curves must stay
};

struct FoundConnections {
  std::vector<FoundConnection> curves;  ///< sorted by optical path
  ConnectionStatistics statistics;
};

/// Scene keys of the command `trace`: rays through an index field, or the ray curves between two
/// points in it.
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

/// A parallel beam of rays about an axis.
struct ParallelBeam {
  Vec3 origin, direction;
  double radius;
};

struct TraceScene {
  SceneField field;
  Stage stage;  ///< geometry with the bodies; rays do not end at its outer boundary
  RayStops stops;
  RaySteps steps;
  /// Starts of rays; empty if curves between two points are searched
  std::vector<RayStart> starts = {};
  std::optional<CurveSearch> curves = {};
  std::vector<RayAperture> apertures = {};
  std::optional<ImagePlane> image = {};
  std::optional<ParallelBeam> beam = {};  ///< set if the rays are parallel light
  std::optional<double> wavelength = {};  ///< vacuum wavelength, if given
  std::size_t path_points = 0;            ///< number of stored points of each ray or curve; 0: none
  double length_unit = 1;                 ///< metres per unit of length
};

/// Makes the scene. Throws InputError for invalid values. The overload without `keys` also throws
/// it for values that no part of the scene uses.
TraceScene make_trace_scene(const Keys& keys, const TraceValues& values);
TraceScene make_trace_scene(const TraceValues& values);

std::vector<TracedRay> trace_rays(const TraceScene& scene);

/// Finds the ray curves between the two points that cross no stop surface and stay within the ball
/// or grid of the field. Throws InputError.
FoundConnections find_connections(const TraceScene& scene, std::uint64_t seed);
/// Traces each curve as a ray of the same length, which stores points along the curve.
std::vector<TracedRay> rays_along(const TraceScene& scene, const FoundConnections& found);

}  // namespace flatspeckle::grin

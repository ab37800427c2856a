#include "grin/trace/trace_datasets.h"

#include <algorithm>
#include <limits>

#include "core/numbers/constants.h"
#include "core/result/result_group.h"
#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

const DatasetTable rays_table{
    .name = "rays",
    .rows =
        {{"ray", Data::numbers, "", "1", "number of the ray"},
         {"curve", Data::numbers, "", "1",
          "number of the curve; curves are sorted by optical path"},
         {"start/x", Data::real, "ray", "length", "x of the start"},
         {"start/y", Data::real, "ray", "length", "y of the start"},
         {"start/z", Data::real, "ray", "length", "z of the start"},
         {"start/dx", Data::real, "THING", "1", "x of the unit tangent at the start"},
         {"start/dy", Data::real, "THING", "1", "y of the unit tangent at the start"},
         {"start/dz", Data::real, "THING", "1", "z of the unit tangent at the start"},
         {"exit/x", Data::real, "ray", "length", "x of the end"},
         {"exit/y", Data::real, "ray", "length", "y of the end"},
         {"exit/z", Data::real, "ray", "length", "z of the end"},
         {"exit/dx", Data::real, "THING", "1", "x of the unit tangent at the end"},
         {"exit/dy", Data::real, "THING", "1", "y of the unit tangent at the end"},
         {"exit/dz", Data::real, "THING", "1", "z of the unit tangent at the end"},
         {"spot_radius", Data::real, "", "length",
          "root mean square distance of the ray ends on a stop surface from their mean; of all "
          "ends if no ray reaches a stop surface"},
         {"optical_path_spread", Data::real, "", "length",
          "difference between the longest and the shortest optical path of the rays that "
          "spot_radius uses"},
         {"arc_length", Data::real, "THING", "length", "length of the curve"},
         {"optical_path", Data::real, "THING", "length", "integral of the index along the curve"},
         {"time", Data::real, "THING", "s", "optical path divided by the speed of light"},
         {"status", Data::count, "ray", "1",
          "0: ended on a stop surface, 1: at max_length, 2: at the edge of the grid, 3: absorbed "
          "by "
          "a body or an aperture"},
         {"surface", Data::count, "ray", "1",
          "number of the stop surface, in the order planes, spheres, boxes; for status 1 to 3 "
          "the number of stop surfaces"},
         {"transmittance", Data::real, "ray", "1",
          "fraction of the power of unpolarised light transmitted through the surfaces and media "
          "of bodies"},
         {"steps", Data::count, "ray", "1", "steps of the integrator"},
         {"invariants/index_mismatch", Data::invariant, "ray", "1",
          "largest difference between |v| and the index, where v is the index times the unit "
          "tangent; adaptive integration checks after each step, before |v| is rescaled, fixed "
          "steps after every fourth step and the last"},
         {"invariants/angular_momentum", Data::real, "ray", "length",
          "magnitude of the angular momentum (x - centre) cross v at the start"},
         {"invariants/angular_momentum_change", Data::real, "ray", "length",
          "magnitude of the change of the angular momentum from start to end"},
         {"invariants/axial_momentum", Data::real, "ray", "1",
          "magnitude of the component of v along the axis at the start"},
         {"invariants/axial_momentum_change", Data::real, "ray", "1",
          "magnitude of the change of the axial component of v from start to end"},
         {"invariants/axial_rotation", Data::real, "ray", "length",
          "magnitude of the component of the angular momentum along the axis at the start"},
         {"invariants/axial_rotation_change", Data::real, "ray", "length",
          "magnitude of the change of the axial angular momentum from start to end"},
         {"invariants/transverse_momentum", Data::real, "ray", "1",
          "magnitude of the component of v perpendicular to the index gradient, n sin(angle), at "
          "the start"},
         {"invariants/transverse_momentum_change", Data::real, "ray", "1",
          "magnitude of the change of the transverse component of v from start to end"},
         {"image/ray", Data::scale, "", "1", "numbers of the rays in the image"},
         {"image/x", Data::real, "image/ray", "length",
          "x of the intersection with the plane, relative to the plane's point"},
         {"image/y", Data::real, "image/ray", "length",
          "y of the intersection with the plane, relative to the plane's point"},
         {"image/slope_x", Data::real, "image/ray", "1",
          "ray slope: dx per distance along the normal"},
         {"image/slope_y", Data::real, "image/ray", "1",
          "ray slope: dy per distance along the normal"},
         {"image/path_difference", Data::real, "image/ray", "length",
          "optical path of the ray to the foot of the perpendicular from the spot's centroid, "
          "minus the mean over the rays"},
         {"image/least_path_difference", Data::real, "image/ray", "length",
          "optical path difference about the point image/best_x, best_y, best_z, for which the "
          "mean square is smallest"},
         {"image/distance", Data::real, "", "length",
          "distance along the normal from image_plane to the plane of the image; 0 without "
          "refocus"},
         {"image/focus", Data::real, "", "length",
          "distance from image_plane to the smallest spot, along the normal; absent for parallel "
          "rays"},
         {"image/best_x", Data::real, "", "length",
          "x of the point about which path differences are smallest; absent for parallel rays"},
         {"image/best_y", Data::real, "", "length",
          "y of the point about which path differences are smallest"},
         {"image/best_z", Data::real, "", "length",
          "z of the point about which path differences are smallest"},
         {"image/spot_radius", Data::real, "", "length",
          "root mean square distance of the intersections from their centroid"},
         {"image/spot_extent", Data::real, "", "length", "largest distance from the centroid"},
         {"image/path_difference_rms", Data::real, "", "length",
          "root mean square of image/path_difference"},
         {"image/least_path_difference_rms", Data::real, "", "length",
          "root mean square of image/least_path_difference"},
         {"image/focal_length", Data::real, "", "length",
          "rear focal length f' = -h/u' of rays close to the axis of a parallel beam, which leave "
          "at the angle u' if they enter at the height h"},
         {"image/power", Data::real, "", "1/length",
          "refractive power: index behind the system over image/focal_length"},
         {"image/back_focal_length", Data::real, "", "length",
          "distance from the last surface of a body to the paraxial focus"},
         {"image/f_number", Data::real, "", "1",
          "magnitude of image/focal_length over the diameter of the beam"},
         {"image/paraxial_x", Data::real, "", "length", "x of the paraxial focus"},
         {"image/paraxial_y", Data::real, "", "length", "y of the paraxial focus"},
         {"image/paraxial_z", Data::real, "", "length", "z of the paraxial focus"},
         {"image/aperture", Data::real, "", "1",
          "numerical aperture of the rays behind the system"},
         {"image/strehl", Data::real, "", "1",
          "Strehl ratio: square of the modulus of the mean of exp(2 pi i image/path_difference / "
          "wavelength)"},
         {"image/best_strehl", Data::real, "", "1", "Strehl ratio by image/least_path_difference"},
         {"image/mtf_frequency", Data::scale, "", "1/length",
          "spatial frequencies, up to the cutoff 2 image/aperture / wavelength"},
         {"image/mtf_x", Data::real, "image/mtf_frequency", "1",
          "modulation transfer function in the plane of the image for structures that vary along "
          "x"},
         {"image/mtf_y", Data::real, "image/mtf_frequency", "1",
          "modulation transfer function for structures that vary along y"},
         {"image/mtf_ideal", Data::real, "image/mtf_frequency", "1",
          "modulation transfer function without path differences"},
         {"spreading", Data::real, "curve", "length^2",
          "|J|: cross-sectional area of a thin tube of rays at the end of the curve per solid "
          "angle at the start"},
         {"caustics", Data::count, "curve", "1", "number of caustics along the curve"},
         {"found", Data::count, "curve", "1", "number of trials that converged to the curve"},
         {"path_point", Data::numbers, "", "1",
          "number of a point; points are equidistant in arc length"},
         {"path/x", Data::real, "THING path_point", "length", "x of the points"},
         {"path/y", Data::real, "THING path_point", "length", "y of the points"},
         {"path/z", Data::real, "THING path_point", "length", "z of the points"},
         {"map_z", Data::scale, "", "length", "depth of the index map's points"},
         {"map_x", Data::scale, "", "length", "x of the index map's points"},
         {"map_y", Data::scale, "", "length", "y of the index map's points"},
         {"index_map", Data::real, "ACROSS map_z", "1", "index in a plane; 0 outside the field"}},
    .attributes = {{"index_map", "x", "float64", "x of the map's plane, if it is normal to x"},
                   {"index_map", "y", "float64", "y of the map's plane, if it is normal to y"}},
    .roles = {{"THING", {"ray", "curve"}}, {"ACROSS", {"map_x", "map_y"}}}};

namespace {

/// Writes the components of a vector under name + "x", "y", "z".
template <class Things, class Value>
void put_vectors(const ResultGroup& root, const std::string& name, const Things& things,
                 const Value& value) {
  for (int i = 0; i < 3; ++i)
    root.put(name + "xyz"[i],
             column(things, [&](const auto& thing) { return Vec3(value(thing))[i]; }));
}

using Momentum = Vec3 (*)(const RayInvariants&);

/// Writes the magnitude of an invariant of the rays at their start, and the magnitude of its change
/// from start to end.
void put_invariant(const ResultGroup& root, const std::vector<TracedRay>& rays,
                   const std::string& name, Momentum value) {
  root.put("invariants/" + name,
           column(rays, [&](const TracedRay& ray) { return value(ray.first).norm(); }));
  root.put("invariants/" + name + "_change", column(rays, [&](const TracedRay& ray) {
             return (value(ray.last) - value(ray.first)).norm();
           }));
}

/// Returns the deviation of each ray from |v| = n and the largest acceptable deviation. For
/// adaptive steps this limit is a multiple of the tolerance, because step errors accumulate along
/// the ray. Fixed steps have no error estimate, so their limit is constant. Both limits include the
/// rounding of positions, measured in units of the longest step.
std::vector<Invariant> index_mismatches(const RaySteps& steps, const std::vector<TracedRay>& rays) {
  constexpr double accumulated = 1000, of_fixed_steps = 1e-3;
  constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();
  const double limit = steps.tolerance ? accumulated * *steps.tolerance : of_fixed_steps;
  std::vector<Invariant> mismatches;
  for (const TracedRay& ray : rays) {
    const double places = ray.end.x.cwiseAbs().maxCoeff() / steps.longest;
    mismatches.push_back({ray.index_mismatch, limit + rounding * places});
  }
  return mismatches;
}

void write_invariants(const ResultGroup& root, const TraceScene& scene,
                      const std::vector<TracedRay>& rays) {
  using Invariants = RayInvariants;
  const Symmetry symmetry = scene.field.symmetry;
  root.check("invariants/index_mismatch", index_mismatches(scene.steps, rays));
  if (symmetry == Symmetry::sphere)
    put_invariant(root, rays, "angular_momentum",
                  [](const Invariants& i) -> Vec3 { return i.angular_momentum; });
  if (symmetry == Symmetry::guide || symmetry == Symmetry::round_guide)
    put_invariant(root, rays, "axial_momentum",
                  [](const Invariants& i) { return Vec3(i.axial_momentum, 0, 0); });
  if (symmetry == Symmetry::round_guide)
    put_invariant(root, rays, "axial_rotation",
                  [](const Invariants& i) { return Vec3(i.axial_rotation, 0, 0); });
  if (symmetry == Symmetry::stratified)
    put_invariant(root, rays, "transverse_momentum",
                  [](const Invariants& i) -> Vec3 { return i.transverse; });
}

template <class Things, class End>
void write_lengths(const ResultGroup& root, const Things& things, const End& end_of,
                   double length_unit) {
  const auto path = [&](const auto& thing) { return end_of(thing).optical_path; };
  root.put("arc_length", column(things, [&](const auto& t) { return end_of(t).arc_length; }));
  root.put("optical_path", column(things, path));
  root.put("time",
           column(things, [&](const auto& t) { return path(t) * length_unit / light_speed; }));
}

/// Rectangle of the index map, spanned by z and the transverse axis `up`. `at` is its coordinate
/// along the other transverse axis, `out`.
struct MapPlane {
  int up, out;
  double low_z, high_z, low, high, at;
};

MapPlane plane_of(const std::vector<TracedRay>& rays) {
  Vec3 low = rays.front().path.front(), high = low;
  for (const auto& ray : rays)
    for (const Vec3& x : ray.path) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  const Vec3 size = high - low;
  const int up = size[0] >= size[1] ? 0 : 1, out = 1 - up;
  const double length = size.maxCoeff(), rim = 0.02 * length;
  // Margin of the map on each side: at most half the width of a thin bundle, or 1/20 of the
  // length of a straight ray
  const double margin = size[up] > 1e-6 * length
                            ? std::clamp(0.015 * length, 0.15 * size[up], 0.5 * size[up])
                            : 0.05 * length;
  return {up,
          out,
          low[2] - rim,
          high[2] + rim,
          low[up] - margin,
          high[up] + margin,
          (low[out] + high[out]) / 2};
}

std::vector<double> evenly(double low, double high, std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1));
  return values;
}

void write_index_map(ResultFile& file, const TraceScene& scene,
                     const std::vector<TracedRay>& rays) {
  constexpr std::size_t pixels = 201;
  const MapPlane plane = plane_of(rays);
  const std::string up(1, "xyz"[plane.up]), out(1, "xyz"[plane.out]);
  const auto z = evenly(plane.low_z, plane.high_z, pixels);
  const auto across = evenly(plane.low, plane.high, pixels);
  std::vector<double> map;
  for (double u : across)
    for (double w : z) {
      Vec3 x(0, 0, w);
      x[plane.up] = u;
      x[plane.out] = plane.at;
      map.push_back(index_at(scene.field, scene.stage, x));
    }
  const ResultGroup root(file, rays_table);
  root.put("map_z", z);
  root.put("map_" + up, across);
  file.bind("ACROSS", {"map_" + up});
  root.put("index_map", map);
  root.attribute("index_map", out, plane.at);
}

}  // namespace

std::vector<RayState> ends_to_print(const std::vector<TracedRay>& rays) {
  std::vector<RayState> all, on_surface;
  for (const TracedRay& ray : rays) {
    if (ray.status != RayStatus::absorbed) all.push_back(ray.end);
    if (ray.status == RayStatus::surface) on_surface.push_back(ray.end);
  }
  return on_surface.empty() ? all : on_surface;
}

double spot_radius(const std::vector<RayState>& ends) {
  const auto count = static_cast<double>(ends.size());
  Vec3 mean = Vec3::Zero();
  for (const RayState& end : ends) mean += end.x / count;
  double square = 0;
  for (const RayState& end : ends) square += (end.x - mean).squaredNorm() / count;
  return std::sqrt(square);
}

void write_rays(ResultFile& file, const TraceScene& scene, const std::vector<TracedRay>& rays) {
  const ResultGroup root(file, rays_table);
  root.number("ray", rays.size());
  file.bind("THING", {"ray"});
  put_vectors(root, "start/", scene.starts, [](const RayStart& s) { return s.x; });
  put_vectors(root, "start/d", scene.starts, [](const RayStart& s) { return s.direction; });
  put_vectors(root, "exit/", rays, [](const TracedRay& r) { return r.end.x; });
  put_vectors(root, "exit/d", rays, [](const TracedRay& r) { return r.end.v.normalized(); });
  write_lengths(root, rays, std::mem_fn(&TracedRay::end), scene.length_unit);
  const auto printed = ends_to_print(rays);
  if (!printed.empty()) {  // empty if all rays are absorbed
    root.put("spot_radius", spot_radius(printed));
    const auto paths = column(printed, &RayState::optical_path);
    const auto [shortest, longest] = std::ranges::minmax(paths);
    root.put("optical_path_spread", longest - shortest);
  }
  root.put("status", column(rays, &TracedRay::status));
  root.put("surface", column(rays, &TracedRay::surface));
  if (!scene.stage.bodies.empty())
    root.put("transmittance", column(rays, &TracedRay::transmittance));
  root.put("steps", column(rays, &TracedRay::steps));
  write_invariants(root, scene, rays);
}

void write_system(ResultFile& file, const ParaxialSystem& system) {
  const ResultGroup root(file, rays_table);
  root.put("image/focal_length", system.focal_length);
  root.put("image/power", system.power);
  if (system.back_focal_length) root.put("image/back_focal_length", *system.back_focal_length);
  root.put("image/f_number", system.f_number);
  for (int i = 0; i < 3; ++i) root.put(std::string("image/paraxial_") + "xyz"[i], system.focus[i]);
}

void write_quality(ResultFile& file, const ImageQuality& quality) {
  const ResultGroup root(file, rays_table);
  root.put("image/aperture", quality.aperture);
  root.put("image/strehl", quality.strehl);
  root.put("image/best_strehl", quality.best_strehl);
  if (!quality.modulation) return;
  root.put("image/mtf_frequency", quality.modulation->frequency);
  root.put("image/mtf_x", quality.modulation->along_x);
  root.put("image/mtf_y", quality.modulation->along_y);
  root.put("image/mtf_ideal", quality.modulation->of_ideal);
}

void write_image(ResultFile& file, const RayImage& image) {
  const ResultGroup root(file, rays_table);
  using Ray = RayImage::Ray;
  const auto put = [&](const char* name, const auto& value) {
    root.put(std::string("image/") + name, column(image.rays, value));
  };
  put("ray", [](const Ray& ray) { return static_cast<double>(ray.number); });
  put("x", [](const Ray& ray) { return ray.at[0]; });
  put("y", [](const Ray& ray) { return ray.at[1]; });
  put("slope_x", [](const Ray& ray) { return ray.slope[0]; });
  put("slope_y", [](const Ray& ray) { return ray.slope[1]; });
  put("path_difference", &Ray::path_difference);
  put("least_path_difference", &Ray::least_path_difference);
  root.put("image/distance", image.distance);
  if (image.focus) root.put("image/focus", *image.focus);
  if (image.best_point)
    for (int i = 0; i < 3; ++i)
      root.put(std::string("image/best_") + "xyz"[i], (*image.best_point)[i]);
  root.put("image/spot_radius", image.spot_radius);
  root.put("image/spot_extent", image.spot_extent);
  root.put("image/path_difference_rms", root_mean_square(image, &Ray::path_difference));
  root.put("image/least_path_difference_rms", root_mean_square(image, &Ray::least_path_difference));
}

void write_connections(ResultFile& file, const TraceScene& scene, const FoundConnections& found) {
  write_trials(file, found.statistics);
  if (found.curves.empty()) return;
  std::vector<Connection> curves;
  for (const auto& [curve, times] : found.curves) curves.push_back(curve);
  const ResultGroup root(file, rays_table);
  root.number("curve", curves.size());
  file.bind("THING", {"curve"});
  put_vectors(root, "start/d", curves, std::mem_fn(&Connection::start_direction));
  put_vectors(root, "exit/d", curves, std::mem_fn(&Connection::end_direction));
  write_lengths(root, curves, std::identity(), scene.length_unit);
  root.put("spreading", column(curves, &Connection::spreading));
  root.put("caustics", column(curves, &Connection::caustics));
  root.put("found", column(found.curves, &FoundConnection::found));
}

void write_paths(ResultFile& file, const TraceScene& scene, const std::vector<TracedRay>& rays) {
  const ResultGroup root(file, rays_table);
  root.number("path_point", rays.front().path.size());
  for (int i = 0; i < 3; ++i) {
    std::vector<double> values;
    for (const auto& ray : rays)
      for (const Vec3& x : ray.path) values.push_back(x[i]);
    root.put(std::string("path/") + "xyz"[i], values);
  }
  write_index_map(file, scene, rays);
}

}  // namespace flatspeckle::grin

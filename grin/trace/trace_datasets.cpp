#include "grin/trace/trace_datasets.h"

#include <algorithm>
#include <limits>

#include "core/result/result_group.h"
#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

const DatasetTable rays_table{
    .name = "rays",
    .rows =
        {{"ray", Data::numbers, "", "1", "number of the ray"},
         {"curve", Data::numbers, "", "1", "number of the curve, by optical path"},
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
          "root mean square distance from their mean of the ends on a stop surface; of all where "
          "there are none"},
         {"optical_path_spread", Data::real, "", "length",
          "between the longest and the shortest optical path of the same rays"},
         {"arc_length", Data::real, "THING", "length", "length of the curve"},
         {"optical_path", Data::real, "THING", "length", "integral of the index along the curve"},
         {"time", Data::real, "THING", "s", "optical path over the speed of light"},
         {"status", Data::count, "ray", "1",
          "0: ended on a stop surface, 1: at max_length, 2: at the edge of the grid"},
         {"surface", Data::count, "ray", "1",
          "number of the surface: planes, spheres, boxes; of status 1 and 2, how many there "
          "are"},
         {"transmittance", Data::real, "ray", "1",
          "part of unpolarised light's power that is left by reflection at bodies and by their "
          "media"},
         {"steps", Data::count, "ray", "1", "steps of the integrator"},
         {"invariants/index_mismatch", Data::invariant, "ray", "1",
          "largest difference of |v| and the index: after each step controlled by a tolerance, "
          "before they are made equal; of equal steps, after every fourth and the last"},
         {"invariants/angular_momentum", Data::real, "ray", "length",
          "length of (x - centre) cross v, at the start"},
         {"invariants/angular_momentum_change", Data::real, "ray", "length",
          "how far it is off at the end"},
         {"invariants/axial_momentum", Data::real, "ray", "1",
          "size of v along the axis, at the start"},
         {"invariants/axial_momentum_change", Data::real, "ray", "1",
          "how far it is off at the end"},
         {"invariants/axial_rotation", Data::real, "ray", "length",
          "size of the angular momentum along the axis, at the start"},
         {"invariants/axial_rotation_change", Data::real, "ray", "length",
          "how far it is off at the end"},
         {"invariants/transverse_momentum", Data::real, "ray", "1",
          "length of v across the gradient, n sin(angle), at the start"},
         {"invariants/transverse_momentum_change", Data::real, "ray", "1",
          "how far it is off at the end"},
         {"image/ray", Data::scale, "", "1", "numbers of the rays that the image is of"},
         {"image/x", Data::real, "image/ray", "length",
          "of where rays meet the plane, from its point"},
         {"image/y", Data::real, "image/ray", "length", "the same across"},
         {"image/slope_x", Data::real, "image/ray", "1", "dx by the way along the normal"},
         {"image/slope_y", Data::real, "image/ray", "1", "dy by the way along the normal"},
         {"image/path_difference", Data::real, "image/ray", "length",
          "optical path to the foot of the perpendicular from the spot's mean, less the mean of "
          "those paths"},
         {"image/least_path_difference", Data::real, "image/ray", "length",
          "the same about image/best, where its mean square is least"},
         {"image/distance", Data::real, "", "length",
          "of the plane along its normal from image_plane"},
         {"image/focus", Data::real, "", "length",
          "the same of the plane where the spot is least; not of parallel rays"},
         {"image/best_x", Data::real, "", "length",
          "x of the point about which path differences are least; not of parallel rays"},
         {"image/best_y", Data::real, "", "length", "y of it"},
         {"image/best_z", Data::real, "", "length", "z of it"},
         {"image/spot_radius", Data::real, "", "length",
          "root mean square distance from their mean on the plane"},
         {"image/spot_extent", Data::real, "", "length", "the largest distance from it"},
         {"image/path_difference_rms", Data::real, "", "length",
          "root mean square of image/path_difference"},
         {"image/least_path_difference_rms", Data::real, "", "length",
          "root mean square of image/least_path_difference"},
         {"spreading", Data::real, "curve", "length^2",
          "|J|: area across the curve at its end per solid angle at its start"},
         {"caustics", Data::count, "curve", "1", "caustics on the way"},
         {"found", Data::count, "curve", "1", "trials that ended on it"},
         {"path_point", Data::numbers, "", "1", "number of a point, evenly in arc length"},
         {"path/x", Data::real, "THING path_point", "length", "x of the points"},
         {"path/y", Data::real, "THING path_point", "length", "y of the points"},
         {"path/z", Data::real, "THING path_point", "length", "z of the points"},
         {"map_z", Data::scale, "", "length", "depth of the index map's points"},
         {"map_x", Data::scale, "", "length", "x of the index map's points"},
         {"map_y", Data::scale, "", "length", "y of the index map's points"},
         {"index_map", Data::real, "ACROSS map_z", "1",
          "index in a plane, 0 where there is no field"}},
    .attributes = {{"index_map", "x", "float64", "where its plane lies, if across x"},
                   {"index_map", "y", "float64", "where its plane lies, if across y"}},
    .roles = {{"THING", {"ray", "curve"}}, {"ACROSS", {"map_x", "map_y"}}}};

namespace {

/// name + "x", "y", "z"
template <class Things, class Value>
void put_vectors(const ResultGroup& root, const std::string& name, const Things& things,
                 const Value& value) {
  for (int i = 0; i < 3; ++i)
    root.put(name + "xyz"[i],
             column(things, [&](const auto& thing) { return Vec3(value(thing))[i]; }));
}

using Momentum = Vec3 (*)(const RayInvariants&);

/// An invariant at the start, and how far the end is off it.
void put_invariant(const ResultGroup& root, const std::vector<TracedRay>& rays,
                   const std::string& name, Momentum value) {
  root.put("invariants/" + name,
           column(rays, [&](const TracedRay& ray) { return value(ray.first).norm(); }));
  root.put("invariants/" + name + "_change", column(rays, [&](const TracedRay& ray) {
             return (value(ray.last) - value(ray.first)).norm();
           }));
}

/// Each ray must keep |v| = n. Errors of steps add up along it; of fixed steps none are known. So
/// do roundings of places, which count in units of the longest step.
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

/// A rectangle in z and one transverse axis at a value of the other.
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
  // a thin bundle with as much again on either side; a straight ray, with a twentieth of its length
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

std::vector<RayState> ends_to_tell(const std::vector<TracedRay>& rays) {
  std::vector<RayState> all, on_surface;
  for (const TracedRay& ray : rays) {
    all.push_back(ray.end);
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
  const auto told = ends_to_tell(rays);
  root.put("spot_radius", spot_radius(told));
  const auto paths = column(told, &RayState::optical_path);
  const auto [shortest, longest] = std::ranges::minmax(paths);
  root.put("optical_path_spread", longest - shortest);
  root.put("status", column(rays, &TracedRay::status));
  root.put("surface", column(rays, &TracedRay::surface));
  if (!scene.stage.bodies.empty())
    root.put("transmittance", column(rays, &TracedRay::transmittance));
  root.put("steps", column(rays, &TracedRay::steps));
  write_invariants(root, scene, rays);
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

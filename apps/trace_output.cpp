#include "apps/trace_output.h"

#include <algorithm>

#include "apps/trials_output.h"
#include "grin/rays/light_speed.h"

namespace flatspeckle::apps {

namespace {

using namespace grin;

/// One column of a table over the things of an axis.
class Columns {
 public:
  Columns(ResultFile& file, std::string axis) : file_(file), axis_(std::move(axis)) {}

  template <class Things, class Value>
  void numbers(const Things& things, const std::string& name, const Value& value,
               const std::string& units, const std::string& long_name) {
    std::vector<double> values;
    for (const auto& thing : things) values.push_back(value(thing));
    file_.dataset(name, values, {axis_}, units, long_name);
  }
  template <class Things, class Value>
  void counts(const Things& things, const std::string& name, const Value& value,
              const std::string& long_name) {
    std::vector<std::uint64_t> values;
    for (const auto& thing : things) values.push_back(static_cast<std::uint64_t>(value(thing)));
    file_.dataset(name, values, {axis_}, "1", long_name);
  }
  /// name + "x", "y", "z"
  template <class Things, class Value>
  void vectors(const Things& things, const std::string& name, const Value& value,
               const std::string& units, const std::string& long_name) {
    for (int i = 0; i < 3; ++i)
      numbers(
          things, name + "xyz"[i], [&](const auto& thing) { return Vec3(value(thing))[i]; }, units,
          std::string(1, "xyz"[i]) + " of " + long_name);
  }

 private:
  ResultFile& file_;
  std::string axis_;
};

using Invariant = Vec3 (*)(const grin::RayInvariants&);

/// An invariant at the start, and how far the end is off it.
void write_invariant(Columns& columns, const std::vector<TracedRay>& rays, const std::string& name,
                     const std::string& units, Invariant value, const std::string& long_name) {
  const std::string start = "invariants/" + name;
  columns.numbers(
      rays, start, [&](const TracedRay& ray) { return value(ray.first).norm(); }, units,
      long_name + ", at the start");
  columns.numbers(
      rays, start + "_change",
      [&](const TracedRay& ray) { return (value(ray.last) - value(ray.first)).norm(); }, units,
      "how far it is off at the end");
}

void write_invariants(Columns& columns, Symmetry symmetry, const std::vector<TracedRay>& rays) {
  columns.numbers(
      rays, "invariants/index_mismatch", [](const TracedRay& ray) { return ray.index_mismatch; },
      "1", "largest difference of |v| and the index at a step's end");
  if (symmetry == Symmetry::sphere)
    write_invariant(
        columns, rays, "angular_momentum", "length",
        [](const grin::RayInvariants& i) -> Vec3 { return i.angular_momentum; },
        "length of (x - centre) cross v");
  if (symmetry == Symmetry::guide || symmetry == Symmetry::round_guide)
    write_invariant(
        columns, rays, "axial_momentum", "1",
        [](const grin::RayInvariants& i) { return Vec3(i.axial_momentum, 0, 0); },
        "size of v along the axis");
  if (symmetry == Symmetry::round_guide)
    write_invariant(
        columns, rays, "axial_rotation", "length",
        [](const grin::RayInvariants& i) { return Vec3(i.axial_rotation, 0, 0); },
        "size of the angular momentum along the axis");
  if (symmetry == Symmetry::stratified)
    write_invariant(
        columns, rays, "transverse_momentum", "1",
        [](const grin::RayInvariants& i) -> Vec3 { return i.transverse; },
        "length of v across the gradient, n sin(angle)");
}

void write_lengths(Columns& columns, const auto& things, const auto& end_of, double length_unit) {
  columns.numbers(
      things, "arc_length", [&](const auto& t) { return end_of(t).arc_length; }, "length",
      "length of the curve");
  columns.numbers(
      things, "optical_path", [&](const auto& t) { return end_of(t).optical_path; }, "length",
      "integral of the index along the curve");
  columns.numbers(
      things, "time",
      [&](const auto& t) { return end_of(t).optical_path * length_unit / light_speed; }, "s",
      "optical path over the speed of light");
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

void write_index_map(ResultFile& file, const SceneField& scene,
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
      map.push_back(index_at(scene, x));
    }
  file.scale("map_z", z, "length", "depth of the index map's points");
  file.scale("map_" + up, across, "length", up + " of the index map's points");
  file.dataset("index_map", map, {"map_" + up, "map_z"}, "1",
               "index in a plane, 0 where there is no field");
  file.attribute("index_map", out, plane.at);
}

}  // namespace

void write_rays(ResultFile& file, const SceneField& scene, const std::vector<RayStart>& starts,
                const std::vector<TracedRay>& rays, double length_unit) {
  file.numbered_scale("ray", rays.size(), "number of the ray");
  Columns columns(file, "ray");
  columns.vectors(
      starts, "start/", [](const RayStart& s) { return s.x; }, "length", "the start");
  columns.vectors(
      starts, "start/d", [](const RayStart& s) { return s.direction; }, "1",
      "the unit tangent at the start");
  columns.vectors(
      rays, "exit/", [](const TracedRay& r) { return r.end.x; }, "length", "the end");
  columns.vectors(
      rays, "exit/d", [](const TracedRay& r) { return r.end.v.normalized(); }, "1",
      "the unit tangent at the end");
  write_lengths(
      columns, rays, [](const TracedRay& r) { return r.end; }, length_unit);
  columns.counts(
      rays, "status", [](const TracedRay& r) { return r.status; },
      "0: ended on a stop surface, 1: at max_length, 2: at the edge of the grid");
  columns.counts(
      rays, "surface", [](const TracedRay& r) { return r.surface; },
      "number of the surface: planes, spheres, boxes; of status 1 and 2, how many there are");
  columns.counts(
      rays, "steps", [](const TracedRay& r) { return r.steps; }, "steps of the integrator");
  write_invariants(columns, scene.symmetry, rays);
}

void write_connections(ResultFile& file, const FoundConnections& found, double length_unit) {
  write_trials(file, found.statistics);
  if (found.curves.empty()) return;
  using Found = grin::FoundConnection;
  file.numbered_scale("curve", found.curves.size(), "number of the curve, by optical path");
  Columns columns(file, "curve");
  columns.vectors(
      found.curves, "start/d", [](const Found& f) { return f.curve.start_direction; }, "1",
      "the unit tangent at the start");
  columns.vectors(
      found.curves, "exit/d", [](const Found& f) { return f.curve.end_direction; }, "1",
      "the unit tangent at the end");
  write_lengths(
      columns, found.curves, [](const Found& f) { return f.curve; }, length_unit);
  columns.numbers(
      found.curves, "spreading", [](const Found& f) { return f.curve.spreading; }, "length^2",
      "|J|: area across the curve at its end per solid angle at its start");
  columns.counts(
      found.curves, "caustics", [](const Found& f) { return f.curve.caustics; },
      "caustics on the way");
  columns.counts(
      found.curves, "found", [](const Found& f) { return f.found; }, "trials that ended on it");
}

void write_paths(ResultFile& file, const SceneField& scene, const std::string& axis,
                 const std::vector<TracedRay>& rays) {
  const std::size_t points = rays.front().path.size();
  file.numbered_scale("path_point", points, "number of a point, evenly in arc length");
  for (int i = 0; i < 3; ++i) {
    std::vector<double> values;
    for (const auto& ray : rays)
      for (const Vec3& x : ray.path) values.push_back(x[i]);
    const std::string name(1, "xyz"[i]);
    file.dataset("path/" + name, values, {axis, "path_point"}, "length", name + " of the points");
  }
  write_index_map(file, scene, rays);
}

}  // namespace flatspeckle::apps

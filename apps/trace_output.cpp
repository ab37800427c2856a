#include "apps/trace_output.h"

#include <algorithm>

#include "core/result/result_group.h"
#include "grin/rays/light_speed.h"
#include "grin/rays/ray_datasets.h"

namespace flatspeckle::apps {

namespace {

using grin::Vec3;

/// name + "x", "y", "z"
template <class Things, class Value>
void put_vectors(const ResultGroup& root, const std::string& name, const Things& things,
                 const Value& value) {
  for (int i = 0; i < 3; ++i)
    root.put(name + "xyz"[i],
             column(things, [&](const auto& thing) { return Vec3(value(thing))[i]; }));
}

using Invariant = Vec3 (*)(const grin::RayInvariants&);

/// An invariant at the start, and how far the end is off it.
void put_invariant(const ResultGroup& root, const std::vector<TracedRay>& rays,
                   const std::string& name, Invariant value) {
  root.put("invariants/" + name,
           column(rays, [&](const TracedRay& ray) { return value(ray.first).norm(); }));
  root.put("invariants/" + name + "_change", column(rays, [&](const TracedRay& ray) {
             return (value(ray.last) - value(ray.first)).norm();
           }));
}

void write_invariants(const ResultGroup& root, Symmetry symmetry,
                      const std::vector<TracedRay>& rays) {
  using Invariants = grin::RayInvariants;
  root.put("invariants/index_mismatch", column(rays, &TracedRay::index_mismatch));
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
  root.put("time", column(things, [&](const auto& t) {
             return path(t) * length_unit / grin::light_speed;
           }));
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
  const ResultGroup root(file, grin::rays_table);
  root.put("map_z", z);
  root.put("map_" + up, across);
  file.bind("ACROSS", {"map_" + up});
  root.put("index_map", map);
  root.attribute("index_map", out, plane.at);
}

}  // namespace

void write_rays(ResultFile& file, const SceneField& scene, const std::vector<RayStart>& starts,
                const std::vector<TracedRay>& rays, double length_unit) {
  const ResultGroup root(file, grin::rays_table);
  root.number("ray", rays.size());
  file.bind("THING", {"ray"});
  put_vectors(root, "start/", starts, [](const RayStart& s) { return s.x; });
  put_vectors(root, "start/d", starts, [](const RayStart& s) { return s.direction; });
  put_vectors(root, "exit/", rays, [](const TracedRay& r) { return r.end.x; });
  put_vectors(root, "exit/d", rays, [](const TracedRay& r) { return r.end.v.normalized(); });
  write_lengths(root, rays, std::mem_fn(&TracedRay::end), length_unit);
  root.put("status", column(rays, &TracedRay::status));
  root.put("surface", column(rays, &TracedRay::surface));
  root.put("steps", column(rays, &TracedRay::steps));
  write_invariants(root, scene.symmetry, rays);
}

void write_connections(ResultFile& file, const FoundConnections& found, double length_unit) {
  write_trials(file, found.statistics);
  if (found.curves.empty()) return;
  std::vector<grin::Connection> curves;
  for (const auto& [curve, times] : found.curves) curves.push_back(curve);
  const ResultGroup root(file, grin::rays_table);
  root.number("curve", curves.size());
  file.bind("THING", {"curve"});
  put_vectors(root, "start/d", curves, std::mem_fn(&grin::Connection::start_direction));
  put_vectors(root, "exit/d", curves, std::mem_fn(&grin::Connection::end_direction));
  write_lengths(root, curves, std::identity(), length_unit);
  root.put("spreading", column(curves, &grin::Connection::spreading));
  root.put("caustics", column(curves, &grin::Connection::caustics));
  root.put("found", column(found.curves, &grin::FoundConnection::found));
}

void write_paths(ResultFile& file, const SceneField& scene, const std::vector<TracedRay>& rays) {
  const ResultGroup root(file, grin::rays_table);
  root.number("path_point", rays.front().path.size());
  for (int i = 0; i < 3; ++i) {
    std::vector<double> values;
    for (const auto& ray : rays)
      for (const Vec3& x : ray.path) values.push_back(x[i]);
    root.put(std::string("path/") + "xyz"[i], values);
  }
  write_index_map(file, scene, rays);
}

}  // namespace flatspeckle::apps

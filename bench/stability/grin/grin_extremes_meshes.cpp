// Bodies of triangles: rays that graze them or lie in their faces; tiny, huge and distant bodies.

#include <cmath>
#include <numbers>

#include "bench/scenes/meshes.h"
#include "bench/scenes/random_fields.h"
#include "bench/stability/extreme_rows.h"
#include "grin/render/flights/space.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;

TriangleMesh moved(TriangleMesh mesh, double scale, const Vec3& to) {
  for (Vec3& corner : mesh.corners) corner = scale * corner + to;
  return mesh;
}

/// Checks that lines cross a torus an even number of times, and that the crossings lie on it to a
/// fraction of the grid spacing.
Finding crossings(double scale, const Vec3& at, double limit) {
  const double spacing = 0.06 * scale;
  const LevelSurface surface = smooth(moved(torus_mesh(), scale, at), spacing);
  RandomStream random(11, 99, 0);
  double worst = 0;
  for (int line = 0; line < 2000; ++line) {
    Vec3 x = at + 2 * scale * random_direction(random);
    const Vec3 d = (at + random_point(random, 0.6 * scale) - x).normalized();
    int count = 0;
    for (double side = 1;; side = -side, ++count) {
      const double distance = surface.crossing_distance(x, d, side);
      if (!(distance < 10 * scale)) break;
      x += distance * d;
      worst = larger(worst, std::abs(surface.distance(x)) / spacing);
    }
    if (count % 2 != 0) return {1, limit};
  }
  return {worst, limit};
}

/// Checks free flights that begin in the planes of a cube's faces and run along the faces and
/// edges.
Finding along_faces(double index) {
  const Stage stage{
      Box{Vec3::Constant(-2), Vec3::Constant(2)}, {}, {Body{smooth(cube_mesh(1), 0.125)}}};
  const Space space(Homogeneous{index - 1}, stage);
  RandomStream random(12, 99, 0);
  int lost = 0;
  for (int flight = 0; flight < 3000; ++flight) {
    Vec3 x(-1.9, 1, random.uniform() * 2 - 1), d = Vec3::UnitX();
    if (flight % 3 == 1) x[2] = 1;
    if (flight % 3 == 2) d = (Vec3(1, 1, x[2]) - x).normalized();
    lost += space.fly({x}, d, random).end != Flight::End::boundary;
  }
  return {lost / 3000.0, 0};
}

/// Checks the fraction of lost rays among those that graze a ball of triangles. Rays are lost if
/// they are trapped or stopped after 10,000 reflections.
Finding lost_by_grazing() {
  const Stage stage{Sphere{Vec3::Zero(), 3}, {}, {Body{smooth(ball_mesh(5), 0.2)}}};
  const Space space(Homogeneous{0.4}, stage);
  RandomStream random(13, 99, 0);
  int lost = 0;
  constexpr int flights = 20000;
  for (int flight = 0; flight < flights; ++flight) {
    const double rho = 1 - 1e-2 * random.uniform(), phi = 2 * std::numbers::pi * random.uniform();
    const Vec3 x(rho * std::cos(phi), rho * std::sin(phi), -2);
    lost += space.fly({x}, Vec3::UnitZ(), random).end != Flight::End::boundary;
  }
  return {lost / static_cast<double>(flights), 1e-3};
}

}  // namespace

void mesh_extremes(ExtremeRows& rows) {
  const std::string on_it = "lines cross it where it is, in units of the spacing";
  rows.add("torus of triangles", on_it, crossings, 1, Vec3(0, 0, 0), 1e-13);
  rows.add("torus of triangles, 1e-9 wide", on_it, crossings, 1e-9, Vec3(0, 0, 0), 1e-13);
  rows.add("torus of triangles, 1e9 wide", on_it, crossings, 1e9, Vec3(0, 0, 0), 1e-13);
  rows.add("torus of triangles, 1e5 of its sizes away", on_it, crossings, 1, Vec3(1e5, 1e5, 1e5),
           1e-8);
  rows.add_each("cube of triangles, index ", {1.0, 1.4, 0.7}, ", light along its faces",
                "share of light that is lost", along_faces);
  rows.add("ball of triangles, light that grazes it", "share of light that is lost",
           lost_by_grazing);
  rows.add_refused("triangles that are not closed", "not a closed surface", [] {
    closed_mesh({Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()});
  });
  rows.add_refused("a spacing as wide as a torus", "too coarse", [] { smooth(torus_mesh(), 0.8); });
}

}  // namespace flatspeckle::bench

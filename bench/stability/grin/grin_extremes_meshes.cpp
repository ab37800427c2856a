// Bodies of triangles: rays that graze them or lie in their faces; tiny, huge and distant bodies.

#include <cmath>
#include <numbers>

#include "bench/scenes/meshes.h"
#include "bench/scenes/random_fields.h"
#include "bench/stability/extreme_rows.h"
#include "grin/rays/surfaces/straight_crossing.h"
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

/// Returns the rms deviation of the normals of the smooth surface of a ball of `8 * 4^times`
/// triangles at the default spacing.
Finding normals_of_coarse_ball(double scale, const Vec3& at) {
  const TriangleMesh mesh = moved(ball_mesh(3), scale, at);
  const CurvedMesh curved = curved_mesh(mesh, 0.52, first_spacing(mesh) / 3);
  return {fit_of(mesh_surface(curved, "spacing"), curved).normal_deviation, 0.01};
}

/// Checks that lines cross an aspheric lens an even number of times, and that the crossings lie on
/// it.
Finding crossings_of_asphere(double scale, const Vec3& at, double limit) {
  const AsphericFace front{1.2 / scale, -0.8, {0.1 / std::pow(scale, 3), 0, 0}},
      back{-0.9 / scale, 1.1, {0, 0.05 / std::pow(scale, 5), 0}};
  const Surface lens = *AsphericLens::make(at, 0.7 * scale, front, back, 0.8 * scale);
  RandomStream random(14, 99, 0);
  double worst = 0;
  for (int line = 0; line < 2000; ++line) {
    Vec3 x = at + 3 * scale * random_direction(random);
    const Vec3 d = (at + random_point(random, 0.6 * scale) - x).normalized();
    int count = 0;
    for (bool leaves = false; count < 9; leaves = !leaves, ++count) {
      const double length = leaves ? exit_distance(lens, x, d) : entry_distance(lens, x, d);
      if (!(length < 10 * scale)) break;
      x += length * d;
      worst = larger(worst, std::abs(distance(lens, x)) / scale);
    }
    if (count % 2 != 0) return {1, limit};
  }
  return {worst, limit};
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
  rows.add("coarse ball of triangles", "normals of the sphere", normals_of_coarse_ball, 1,
           Vec3(0, 0, 0));
  rows.add("coarse ball of triangles, 1e-6 wide, 100 of its sizes away", "normals of the sphere",
           normals_of_coarse_ball, 1e-6, Vec3(1e-4, 0, 0));
  const std::string on_lens = "lines cross it where it is, in units of its size";
  rows.add("aspheric lens", on_lens, crossings_of_asphere, 1, Vec3(0, 0, 0), 1e-13);
  rows.add("aspheric lens, 1e-9 wide", on_lens, crossings_of_asphere, 1e-9, Vec3(0, 0, 0), 1e-13);
  rows.add("aspheric lens, 1e5 of its sizes away", on_lens, crossings_of_asphere, 1,
           Vec3(1e5, 1e5, 1e5), 1e-9);
  rows.add_refused("triangles that are not closed", "not a closed surface", [] {
    closed_mesh({Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()});
  });
  rows.add_refused("a spacing as wide as a torus", "too coarse", [] { smooth(torus_mesh(), 0.8); });
}

}  // namespace flatspeckle::bench

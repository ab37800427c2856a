#include <cmath>
#include <map>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/random.h"
#include "grin/rays/trace.h"
#include "grin/surfaces/mesh_distance.h"
#include "grin/surfaces/signed_distance.h"

namespace flatspeckle::grin {

namespace {

TriangleMesh cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.corners.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// An octahedron, each triangle cut in four `times` times and thrown onto the unit sphere.
TriangleMesh ball(int times) {
  TriangleMesh mesh;
  mesh.corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int round = 0; round < times; ++round) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), mesh.corners.size());
      if (is_new) mesh.corners.push_back((mesh.corners[a] + mesh.corners[b]).normalized());
      return place->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  return mesh;
}

Vec3 random_point(RandomStream& random, double half) {
  return Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5) * 2 * half;
}

}  // namespace

TEST_CASE("Distance to a mesh: a cube's in closed form, its winding number") {
  const MeshDistance exact(cube());
  const Box box{{0, 0, 0}, {1, 1, 1}};
  RandomStream random(1, 1, 0);
  for (int i = 0; i < 500; ++i) {
    const Vec3 x = Vec3::Constant(0.5) + random_point(random, 1.5);
    CHECK(exact.unsigned_distance(x) == doctest::Approx(std::abs(box.distance(x))));
    CHECK(exact.winding_number(x) == doctest::Approx(box.distance(x) < 0 ? 1 : 0));
  }
}

TEST_CASE("A distance grid has the mesh's faces, and never says more than the true distance") {
  const DistanceGrid grid(cube(), 16);
  const Box box{{0, 0, 0}, {1, 1, 1}};
  for (const double t : {0.2, 0.5, 0.77}) {
    CHECK(std::abs(grid.distance({t, 0.4, 1})) < 1e-14);
    CHECK(std::abs(grid.distance({0, t, 0.3})) < 1e-14);
    CHECK((grid.normal({t, 0.4, 1}) - Vec3::UnitZ()).norm() < 1e-13);
  }
  RandomStream random(1, 1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = Vec3::Constant(0.5) + random_point(random, 1.5);
    // Edges are rounded over a cell.
    const double allowed = std::abs(box.distance(x)) + 0.6 * grid.spacing();
    CHECK(std::abs(grid.distance(x)) <= allowed);
    if (std::abs(box.distance(x)) > 0.6 * grid.spacing())
      CHECK((grid.distance(x) < 0) == (box.distance(x) < 0));
  }
}

TEST_CASE("A ball of triangles: rays find it to the square of the spacing, its clearance is safe") {
  const TriangleMesh mesh = ball(4);
  RandomStream random(1, 1, 2);
  double errors[2] = {0, 0};
  for (const int fine : {0, 1}) {
    const std::vector<Surface> surfaces{DistanceGrid(mesh, fine ? 32 : 16)};
    FixedSteps<Leapfrog> none{1};
    for (int i = 0; i < 200; ++i) {
      const Vec3 from = random_point(random, 1).normalized() * 4;
      RayState ray = start_ray(Homogeneous{}, from, random_point(random, 0.3) - from);
      const double promised = distance(surfaces[0], from);
      CHECK(trace(Homogeneous{}, surfaces, {10, 1e-9}, none, ray).stop == Stop::surface);
      CHECK(ray.arc_length >= promised - 1e-9);
      CHECK(normal(surfaces[0], ray.x).dot(ray.x.normalized()) > 0.98);
      errors[fine] = std::max(errors[fine], std::abs(ray.x.norm() - 1));
    }
  }
  CHECK(errors[0] < 0.02);
  CHECK(errors[1] < 0.006);
}

TEST_CASE("Bad meshes are refused") {
  CHECK_THROWS_AS(DistanceGrid({}, 16), InputError);
  CHECK_THROWS_AS(DistanceGrid(cube(), 1), InputError);
  TriangleMesh wrong = cube();
  wrong.triangles[3][1] = 8;
  CHECK_THROWS_AS(DistanceGrid(wrong, 16), InputError);
  wrong = cube();
  wrong.corners[2][0] = std::nan("");
  CHECK_THROWS_AS(DistanceGrid(wrong, 16), InputError);
}

}  // namespace flatspeckle::grin

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "bench/scenes/meshes.h"
#include "core/error.h"
#include "grin/rays/surfaces/curved_mesh.h"
#include "grin/rays/surfaces/mesh_file.h"
#include "grin/rays/surfaces/mesh_surface.h"

namespace flatspeckle::grin::tests::test_curved_mesh {

using namespace bench;

namespace {

constexpr double pi = std::numbers::pi;

/// A cylinder of radius 1 about the z axis between z = -1 and 1, of `sides` plane sides.
std::vector<Vec3> cylinder(int sides) {
  std::vector<Vec3> corners;
  const auto at = [&](int i, double z) {
    return Vec3(std::cos(2 * pi * i / sides), std::sin(2 * pi * i / sides), z);
  };
  for (int i = 0; i < sides; ++i) {
    corners.insert(corners.end(), {at(i, -1), at(i + 1, -1), at(i + 1, 1)});
    corners.insert(corners.end(), {at(i, -1), at(i + 1, 1), at(i, 1)});
    corners.insert(corners.end(), {{0, 0, 1}, at(i, 1), at(i + 1, 1)});
    corners.insert(corners.end(), {{0, 0, -1}, at(i + 1, -1), at(i, -1)});
  }
  return corners;
}

std::vector<Vec3> soup(const TriangleMesh& mesh) {
  std::vector<Vec3> corners;
  for (const auto& triangle : mesh.triangles)
    for (const int corner : triangle) corners.push_back(mesh.corners[corner]);
  return corners;
}

}  // namespace

TEST_CASE("curved mesh: the patches of a ball lie on it, at fourth order in their size") {
  double before = 1;
  for (const int times : {2, 3, 4}) {
    const CurvedMesh ball = curved_mesh(ball_mesh(times), 0.8, 0.02);
    double off = 0;
    for (const Vec3& corner : ball.mesh.corners) off = std::max(off, std::abs(corner.norm() - 1));
    CHECK(off < before / 10);
    before = off;
  }
  CHECK(before < 1e-5);
}

TEST_CASE("curved mesh: plane faces and edges beyond the crease stay as they are") {
  const CurvedMesh cube = curved_mesh(cube_mesh(1), 0.8, 0.1);
  CHECK(cube.mesh.triangles.size() == 12);
  CHECK(cube.creases.size() == 12);
  CHECK(cube.largest_bend < 1e-9);
  CHECK(volume(cube.mesh) == doctest::Approx(8).epsilon(1e-15));
  const CurvedMesh flat = curved_mesh(ball_mesh(2), 0, 0.1);
  CHECK(volume(flat.mesh) == volume(ball_mesh(2)));
}

TEST_CASE("curved mesh: a cylinder of 16 sides becomes round, its ends stay plane") {
  const CurvedMesh curved = curved_mesh(closed_mesh(cylinder(16)), 0.52, 0.05);
  double off = 0;
  for (const Vec3& x : curved.mesh.corners) {
    if (std::abs(x[2]) < 0.999) off = std::max(off, std::abs(std::hypot(x[0], x[1]) - 1));
    CHECK(std::abs(x[2]) <= 1 + 1e-12);
  }
  CHECK(off < 1e-3);  // the plane sides are off by 0.019
  CHECK(volume(curved.mesh) == doctest::Approx(2 * pi).epsilon(1e-3));
  CHECK(curved.creases.size() == 32);
}

TEST_CASE("default spacing: normals of coarse balls agree with the sphere") {
  const LevelSurface surface =
      mesh_surface(curved_mesh(ball_mesh(3), 0.52, 2.0 / 64 / 3), "spacing");
  const MeshFit fit = fit_of(surface, curved_mesh(ball_mesh(3), 0.52, 2.0 / 64 / 3));
  CHECK(fit.normal_deviation < 0.004);
  CHECK(std::abs(fit.area_change) < 1e-3);
  CHECK(fit.sharp_share == 0);
  for (const Vec3& corner : ball_mesh(4).corners) {
    const Vec3 x = surface.projected(corner);
    CHECK(std::abs(x.norm() - 1) < 2e-4);
    CHECK((surface.normal(x) - x.normalized()).norm() < 0.01);
  }
  // the plane triangles themselves have normals that are off by a tenth
  const LevelSurface facets = mesh_surface(ball_mesh(3), 2.0 / 64, "spacing");
  double off = 0;
  for (const Vec3& corner : ball_mesh(4).corners) {
    const Vec3 x = facets.projected(corner);
    off = std::max(off, (facets.normal(x) - x.normalized()).norm());
  }
  CHECK(off > 0.03);
}

TEST_CASE("closed mesh: triangles of the wrong orientation are reversed") {
  std::vector<Vec3> corners = soup(ball_mesh(3));
  for (std::size_t i = 0; i < corners.size(); i += 21) std::swap(corners[i], corners[i + 1]);
  const TriangleMesh mesh = closed_mesh(corners);
  CHECK(mesh.turned == (corners.size() + 20) / 21);
  CHECK(volume(mesh) == doctest::Approx(volume(ball_mesh(3))).epsilon(1e-14));
}

TEST_CASE("closed mesh: holes are named by place, and closed by welding") {
  std::vector<Vec3> corners = soup(ball_mesh(3));
  corners.erase(corners.begin(), corners.begin() + 3);
  CHECK_THROWS_WITH_AS(closed_mesh(corners), doctest::Contains("1 hole: near"), InputError);
  CHECK_THROWS_WITH_AS(closed_mesh(corners), doctest::Contains("3 open edges"), InputError);
  std::vector<Vec3> apart = soup(cube_mesh(1));
  for (std::size_t i = 0; i < 6; ++i) apart[i] *= 1.001;  // one face
  CHECK_THROWS_AS(closed_mesh(apart), InputError);
  CHECK(volume(closed_mesh(apart, 0.01)) == doctest::Approx(8).epsilon(0.01));
}

TEST_CASE("mesh files: OBJ and PLY of a cube of squares have its triangles") {
  const std::string corners =
      "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
  const std::string obj =
      "# cube\n" + corners +
      "f 4 3 2 1\nf 5/1/1 6/2/1 7 8\nf 1 2 6 5\nf 2 3 7 6\nf -6 -5 -1 -2\nf 4 1 5 8\n";
  CHECK(volume(closed_mesh(corners_of_obj(obj))) == doctest::Approx(8));
  std::string places = corners;
  std::erase(places, 'v');
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face 6\nproperty list uchar int vertex_indices\nend_header\n" +
      places + "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
  CHECK(volume(closed_mesh(corners_of_ply(ply))) == doctest::Approx(8));
  CHECK_THROWS_WITH_AS(corners_of_ply(ply.substr(0, ply.size() - 9)),
                       doctest::Contains("fewer numbers"), InputError);
  CHECK_THROWS_WITH_AS(corners_of_obj(corners + "f 1 2 9\n"), doctest::Contains("does not exist"),
                       InputError);
}

}  // namespace flatspeckle::grin::tests::test_curved_mesh

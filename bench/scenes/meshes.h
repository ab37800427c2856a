#pragma once

#include <cmath>
#include <map>
#include <numbers>

#include "grin/rays/surfaces/mesh_surface.h"

namespace flatspeckle::bench {

/// The cube [-half, half]^3.
inline grin::TriangleMesh cube_mesh(double half) {
  grin::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.corners.push_back(half * grin::Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Returns an approximation of the unit ball: the triangles of an octahedron are divided into four,
/// `times` times, and all new corners are projected onto the unit sphere.
inline grin::TriangleMesh ball_mesh(int times) {
  grin::TriangleMesh mesh;
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

/// A torus about the z axis, of radius 0.6 and tube radius 0.25.
inline grin::TriangleMesh torus_mesh() {
  constexpr int around = 96, across = 48;
  grin::TriangleMesh mesh;
  const auto number = [](int i, int j) { return i % around * across + j % across; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double phi = 2 * std::numbers::pi * i / around,
                   turn = 2 * std::numbers::pi * j / across;
      const double rho = 0.6 + 0.25 * std::cos(turn);
      mesh.corners.emplace_back(rho * std::cos(phi), rho * std::sin(phi), 0.25 * std::sin(turn));
      mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  return mesh;
}

inline grin::LevelSurface smooth(const grin::TriangleMesh& mesh, double spacing) {
  return grin::mesh_surface(mesh, spacing, "spacing");
}

}  // namespace flatspeckle::bench

#include "grin/rays/surfaces/triangle_mesh.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "core/error.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

namespace {

constexpr std::size_t stl_header = 80, bytes_per_triangle = 50;

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) throw InputError("cannot be read");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

bool is_binary(const std::string& bytes) {
  constexpr std::size_t first = stl_header + sizeof(std::uint32_t);
  if (bytes.size() < first) return false;
  const std::size_t triangles = number_at<std::uint32_t>(bytes, stl_header);
  return bytes.size() == first + bytes_per_triangle * triangles;
}

/// Of each triangle a normal, its corners, and two bytes of anything.
std::vector<Vec3> corners_of_binary(const std::string& bytes) {
  std::vector<Vec3> corners;
  for (std::size_t at = stl_header + sizeof(std::uint32_t); at < bytes.size();
       at += bytes_per_triangle)
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      Vec3& x = corners.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis)
        x[axis] = number_at<float>(bytes, at + (3 * corner + axis) * sizeof(float));
    }
  return corners;
}

/// Numbers by strtod, which reads nan and inf as such.
std::vector<Vec3> corners_of_text(const std::string& bytes) {
  std::istringstream words(bytes);
  std::vector<Vec3> corners;
  std::string word;
  if (!(words >> word) || word != "solid") throw InputError("is not an STL file");
  while (words >> word) {
    if (word != "vertex") continue;
    Vec3& x = corners.emplace_back();
    for (double& number : x) {
      char* end = nullptr;
      words >> word;
      number = std::strtod(word.c_str(), &end);
      if (!words || *end != '\0')
        throw InputError("is not an STL file: a vertex must be three numbers");
    }
  }
  if (corners.size() % 3 != 0)
    throw InputError("is not an STL file: a facet must have three vertices");
  return corners;
}

void check_corners(const std::vector<Vec3>& corners) {
  constexpr double farthest = 1e50;
  for (const Vec3& corner : corners)
    if (!(corner.cwiseAbs().maxCoeff() <= farthest))
      throw InputError("corner of a triangle", listed(corner), "must be finite and within 1e50");
}

TriangleMesh with_shared_corners(const std::vector<Vec3>& corners) {
  TriangleMesh mesh;
  std::map<std::array<double, 3>, int> numbers;
  const auto number = [&](const Vec3& x) {
    const auto [place, is_new] = numbers.try_emplace({x[0], x[1], x[2]}, mesh.corners.size());
    if (is_new) mesh.corners.push_back(x);
    return place->second;
  };
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const int a = number(corners[i]), b = number(corners[i + 1]), c = number(corners[i + 2]);
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  }
  return mesh;
}

void check_closed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> more_that_way;
  for (const auto& triangle : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const int from = triangle[i], to = triangle[(i + 1) % 3];
      more_that_way[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  std::size_t open = 0;
  const Vec3* place = nullptr;
  for (const auto& [edge, more] : more_that_way) {
    if (more == 0) continue;
    ++open;
    place = &mesh.corners[edge.first];
  }
  if (open == 0) return;
  std::ostringstream text;
  text << "is not a closed surface whose triangles are turned alike: " << open << " of "
       << more_that_way.size() << " edges belong to one side alone, one of them at "
       << listed(*place);
  throw InputError(text.str());
}

Vec3 doubled_area(const TriangleMesh& mesh, const std::array<int, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  return (mesh.corners[b] - mesh.corners[a]).cross(mesh.corners[c] - mesh.corners[a]);
}

}  // namespace

TriangleMesh read_stl(const std::string& key, const std::filesystem::path& path) {
  try {
    const std::string bytes = contents(path);
    return closed_mesh(is_binary(bytes) ? corners_of_binary(bytes) : corners_of_text(bytes));
  } catch (const InputError& error) {
    throw InputError(key, path.string(), error.what());
  }
}

TriangleMesh closed_mesh(const std::vector<Vec3>& corners) {
  check_corners(corners);
  TriangleMesh mesh = with_shared_corners(corners);
  if (mesh.triangles.empty()) throw InputError("has no triangle with an area");
  check_closed(mesh);
  if (volume(mesh) < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

Box bounds(const TriangleMesh& mesh) {
  Box box{mesh.corners.front(), mesh.corners.front()};
  for (const Vec3& corner : mesh.corners)
    box = {box.low.cwiseMin(corner), box.high.cwiseMax(corner)};
  return box;
}

double volume(const TriangleMesh& mesh) {
  const Vec3 from = mesh.corners.front();
  double six_times = 0;
  for (const auto& triangle : mesh.triangles)
    six_times += doubled_area(mesh, triangle).dot(mesh.corners[triangle[0]] - from);
  return six_times / 6;
}

double area(const TriangleMesh& mesh) {
  double doubled = 0;
  for (const auto& triangle : mesh.triangles) doubled += doubled_area(mesh, triangle).norm();
  return doubled / 2;
}

}  // namespace flatspeckle::grin

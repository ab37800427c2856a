#include "grin/rays/surfaces/stl_file.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "core/error.h"

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

}  // namespace

TriangleMesh read_stl(const std::string& key, const std::filesystem::path& path) {
  try {
    const std::string bytes = contents(path);
    return closed_mesh(is_binary(bytes) ? corners_of_binary(bytes) : corners_of_text(bytes));
  } catch (const InputError& error) {
    throw InputError(key, path.string(), error.what());
  }
}

}  // namespace flatspeckle::grin

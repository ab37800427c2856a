#include "grin/rays/surfaces/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

#include "core/error.h"
#include "core/keys/table_text.h"

namespace flatspeckle::grin {

namespace {

std::string contents(const std::string& key, const std::filesystem::path& path) {
  try {
    return file_bytes(path);
  } catch (const InputError& error) {
    throw InputError(key + " = " + error.what());
  }
}

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char letter) { return std::tolower(letter); });
  return ending;
}

/// Returns the index of a corner that a face of an OBJ file names: "7", "7/1/3" or, counted from
/// the last corner before the face, "-1".
long corner_number(const std::string& word, std::size_t corners) {
  char* end = nullptr;
  const long number = std::strtol(word.c_str(), &end, 10);
  if (end == word.c_str() || (*end != '\0' && *end != '/') || number == 0)
    throw InputError("is not an OBJ file: a face must name corners, not " + word);
  return number > 0 ? number - 1 : static_cast<long>(corners) + number;
}

}  // namespace

void add_polygon(const std::vector<Vec3>& corners, const std::vector<long>& polygon,
                 std::vector<Vec3>& triangles) {
  if (polygon.size() < 3) throw InputError("has a face of fewer than three corners");
  for (const long corner : polygon)
    if (corner < 0 || corner >= static_cast<long>(corners.size()))
      throw InputError("has a face with a corner that does not exist");
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    for (const std::size_t at : {std::size_t{0}, i, i + 1})
      triangles.push_back(corners[static_cast<std::size_t>(polygon[at])]);
}

std::vector<Vec3> corners_of_obj(const std::string& bytes) {
  std::istringstream lines(bytes);
  std::vector<Vec3> corners, triangles;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3& x = corners.emplace_back();
      if (!(words >> x[0] >> x[1] >> x[2]))
        throw InputError("is not an OBJ file: a corner (v) must be three numbers");
    } else if (word == "f") {
      std::vector<long> polygon;
      while (words >> word) polygon.push_back(corner_number(word, corners.size()));
      add_polygon(corners, polygon, triangles);
    }
  }
  return triangles;
}

TriangleMesh read_mesh(const std::string& key, const std::filesystem::path& path,
                       std::optional<double> weld) {
  const std::string bytes = contents(key, path), ending = ending_of(path);
  const bool is_obj = ending == ".obj", is_ply = ending == ".ply";
  try {
    return closed_mesh(is_obj   ? corners_of_obj(bytes)
                       : is_ply ? corners_of_ply(bytes)
                                : corners_of_stl(bytes),
                       weld);
  } catch (const InputError& error) {
    throw InputError(key, path.string(),
                     error.what() + (is_obj || is_ply ? "" : left_out_of_stl(bytes)));
  }
}

}  // namespace flatspeckle::grin

#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "grin/rays/surfaces/mesh_file.h"

namespace flatspeckle::grin {

namespace {

constexpr std::size_t stl_header = 80, bytes_per_triangle = 50;

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

constexpr std::size_t first_triangle = stl_header + sizeof(std::uint32_t);

/// Returns the number of triangles that the header of a binary file contains.
std::size_t counted_triangles(const std::string& bytes) {
  return bytes.size() < first_triangle ? 0 : number_at<std::uint32_t>(bytes, stl_header);
}
std::size_t bytes_of(std::size_t triangles) {
  return first_triangle + bytes_per_triangle * triangles;
}

std::string lower_case(std::string word) {
  for (char& letter : word)
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return word;
}

/// Whether a file is text. Binary files may also begin with "solid", but their size follows from
/// the count in their header.
bool is_text(const std::string& bytes) {
  if (bytes.size() >= first_triangle && bytes.size() == bytes_of(counted_triangles(bytes)))
    return false;
  return bytes.find('\0') == std::string::npos;
}

/// Throws InputError if the file is too short. Bytes after the last counted triangle are ignored.
void check_size(const std::string& bytes) {
  const std::size_t triangles = counted_triangles(bytes), size = bytes_of(triangles);
  if (bytes.size() >= size) return;
  std::ostringstream text;
  text << "is truncated, or its header is wrong: the header counts " << triangles
       << " triangles, which require " << size << " bytes, but the file has " << bytes.size();
  throw InputError(text.str());
}

/// Returns the corners of all triangles of a binary file. Each triangle consists of a normal, three
/// corners, and two bytes of arbitrary content.
std::vector<Vec3> corners_of_binary(const std::string& bytes) {
  check_size(bytes);
  std::vector<Vec3> corners;
  const std::size_t end = bytes_of(counted_triangles(bytes));
  for (std::size_t at = first_triangle; at < end; at += bytes_per_triangle)
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      Vec3& x = corners.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis)
        x[axis] = number_at<float>(bytes, at + (3 * corner + axis) * sizeof(float));
    }
  return corners;
}

/// Returns the corners of all triangles of a text file. Numbers are read by strtod, which accepts
/// nan and inf. Words may be in capitals, and a byte order mark may precede the text.
std::vector<Vec3> corners_of_text(const std::string& bytes) {
  const std::string mark = "\xEF\xBB\xBF";
  std::istringstream words(bytes.starts_with(mark) ? bytes.substr(mark.size()) : bytes);
  std::vector<Vec3> corners;
  std::string word;
  if (!(words >> word) || lower_case(word) != "solid")
    throw InputError("is not an STL file: text must begin with solid");
  while (words >> word) {
    if (lower_case(word) != "vertex") continue;
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

std::vector<Vec3> corners_of_stl(const std::string& bytes) {
  return is_text(bytes) ? corners_of_text(bytes) : corners_of_binary(bytes);
}

std::string left_out_of_stl(const std::string& bytes) {
  const std::size_t size = bytes_of(counted_triangles(bytes));
  if (is_text(bytes) || bytes.size() <= size) return {};
  return " (" + std::to_string(bytes.size() - size) + " bytes after the " +
         std::to_string(counted_triangles(bytes)) +
         " triangles that the header counts are ignored)";
}

}  // namespace flatspeckle::grin

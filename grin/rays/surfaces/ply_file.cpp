#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "grin/rays/surfaces/mesh_file.h"

namespace flatspeckle::grin {

namespace {

/// A property of an element of a PLY file: one number, or a list whose length precedes it.
struct PlyProperty {
  std::string name, type, count_type = {};
};
struct PlyElement {
  std::string name;
  std::size_t count;
  std::vector<PlyProperty> properties = {};
};
struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements = {};
  std::size_t end = 0;  ///< position of the first byte after the header
};

[[noreturn]] void refuse(const std::string& why) {
  throw InputError("is not a PLY file: " + why);
}

PlyHeader header_of(const std::string& bytes) {
  PlyHeader header;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::istringstream words(bytes.substr(at, end - at));
    const bool is_first = at == 0;
    at = end + 1;
    std::string word;
    words >> word;
    if (is_first && word != "ply") refuse("it must begin with ply");
    if (word == "format") words >> header.format;
    if (word == "element") {
      PlyElement element{};
      words >> element.name >> element.count;
      header.elements.push_back(element);
    } else if (word == "property") {
      if (header.elements.empty()) refuse("a property must follow its element");
      PlyProperty property;
      words >> property.type;
      if (property.type == "list") words >> property.count_type >> property.type;
      words >> property.name;
      header.elements.back().properties.push_back(property);
    } else if (word == "end_header") {
      header.end = at;
      return header;
    }
    if (!words && word != "comment" && !word.empty()) refuse("its header is incomplete");
  }
  refuse("its header has no end");
}

/// Reads the numbers after the header, text or binary of either byte order.
class PlyNumbers {
 public:
  PlyNumbers(const std::string& bytes, const PlyHeader& header)
      : bytes_(bytes),
        at_(header.end),
        is_text_(header.format == "ascii"),
        is_swapped_(header.format == "binary_big_endian") {
    if (!is_text_ && !is_swapped_ && header.format != "binary_little_endian")
      refuse("its format must be ascii, binary_little_endian or binary_big_endian");
    if (is_text_) text_.str(bytes.substr(std::min(header.end, bytes.size())));
  }

  double next(const std::string& type) {
    static const std::map<std::string, double (PlyNumbers::*)()> readers{
        {"char", &PlyNumbers::as<std::int8_t>},     {"int8", &PlyNumbers::as<std::int8_t>},
        {"uchar", &PlyNumbers::as<std::uint8_t>},   {"uint8", &PlyNumbers::as<std::uint8_t>},
        {"short", &PlyNumbers::as<std::int16_t>},   {"int16", &PlyNumbers::as<std::int16_t>},
        {"ushort", &PlyNumbers::as<std::uint16_t>}, {"uint16", &PlyNumbers::as<std::uint16_t>},
        {"int", &PlyNumbers::as<std::int32_t>},     {"int32", &PlyNumbers::as<std::int32_t>},
        {"uint", &PlyNumbers::as<std::uint32_t>},   {"uint32", &PlyNumbers::as<std::uint32_t>},
        {"float", &PlyNumbers::as<float>},          {"float32", &PlyNumbers::as<float>},
        {"double", &PlyNumbers::as<double>},        {"float64", &PlyNumbers::as<double>}};
    const auto reader = readers.find(type);
    if (reader == readers.end()) refuse("unknown type of number: " + type);
    return (this->*reader->second)();
  }
  std::size_t next_count(const std::string& type) {
    constexpr double most = 1e4;
    const double count = next(type);
    if (!(count >= 0 && count <= most)) refuse("a list must have 0 to 10000 numbers");
    return static_cast<std::size_t>(count);
  }

 private:
  template <class Number>
  double as() {
    if (is_text_) {
      std::string word;
      text_ >> word;
      char* end = nullptr;
      const double number = std::strtod(word.c_str(), &end);
      if (word.empty() || *end != '\0') refuse("it has fewer numbers than its header states");
      return number;
    }
    if (bytes_.size() - std::min(at_, bytes_.size()) < sizeof(Number))
      refuse("it has fewer numbers than its header states");
    char number_bytes[sizeof(Number)];
    std::memcpy(number_bytes, bytes_.data() + at_, sizeof(Number));
    at_ += sizeof(Number);
    if (is_swapped_) std::reverse(number_bytes, number_bytes + sizeof(Number));
    Number number;
    std::memcpy(&number, number_bytes, sizeof number);
    return static_cast<double>(number);
  }

  const std::string& bytes_;
  std::size_t at_;
  bool is_text_, is_swapped_;
  std::istringstream text_;
};

/// Reads an element. corner: the coordinates x, y and z, as far as it has them. polygon: the list
/// of corners, if it has one.
void read_element(const PlyElement& element, PlyNumbers& numbers, Vec3& corner,
                  std::vector<long>& polygon) {
  for (const PlyProperty& property : element.properties) {
    if (property.count_type.empty()) {
      const double value = numbers.next(property.type);
      if (const auto axis = std::string("xyz").find(property.name);
          property.name.size() == 1 && axis != std::string::npos)
        corner[static_cast<Eigen::Index>(axis)] = value;
      continue;
    }
    const std::size_t count = numbers.next_count(property.count_type);
    const bool is_polygon = property.name.starts_with("vertex_ind");
    for (std::size_t i = 0; i < count; ++i) {
      const double value = numbers.next(property.type);
      if (is_polygon) polygon.push_back(std::abs(value) < 1e9 ? static_cast<long>(value) : -1);
    }
  }
}

}  // namespace

std::vector<Vec3> corners_of_ply(const std::string& bytes) {
  const PlyHeader header = header_of(bytes);
  PlyNumbers numbers(bytes, header);
  std::vector<Vec3> corners, triangles;
  for (const PlyElement& element : header.elements)
    for (std::size_t i = 0; i < element.count; ++i) {
      Vec3 corner = Vec3::Zero();
      std::vector<long> polygon;
      read_element(element, numbers, corner, polygon);
      if (element.name == "vertex") corners.push_back(corner);
      if (element.name == "face") add_polygon(corners, polygon, triangles);
    }
  return triangles;
}

}  // namespace flatspeckle::grin

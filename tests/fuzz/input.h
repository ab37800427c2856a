#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

// Helpers shared by the fuzz targets.

namespace flatspeckle::fuzz {

/// A temporary folder of the process, used as working directory: inputs name files in it. Paths on
/// the command line must be absolute.
class Folder {
 public:
  Folder();
  ~Folder();
};

void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Whether the input was accepted. Invalid input may only throw InputError or IoError; any other
/// exception ends the process.
bool taken(const std::string& what, void (*use)(const std::string&));

/// Ends the process if a number that the program accepted is not finite.
void require_finite(double value);

/// Reads numbers from an input, zeros beyond its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* bytes, std::size_t size) : next_(bytes), end_(bytes + size) {}

  bool empty() const { return next_ == end_; }
  template <typename Number>
  Number take() {
    Number number{};
    const auto left = static_cast<std::size_t>(end_ - next_);
    const std::size_t size = std::min(sizeof number, left);
    std::memcpy(&number, next_, size);
    next_ += size;
    return number;
  }
  /// Returns a number from 0 to count - 1.
  unsigned below(unsigned count) { return take<std::uint8_t>() % count; }

 private:
  const std::uint8_t *next_, *end_;
};

/// Returns the word of a first line "# word", which selects the reader. Scene files and tables
/// treat such a line as a comment.
std::string first_line(std::string_view text);

}  // namespace flatspeckle::fuzz

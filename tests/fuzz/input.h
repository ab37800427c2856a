#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

// Fuzz targets share these.

namespace flatspeckle::fuzz {

/// A folder that goes with the process, made the working directory: inputs name files in it. Paths
/// on the command line must be absolute.
class Folder {
 public:
  Folder();
  ~Folder();
};

void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Bad input may be told in two ways only; whatever else is thrown ends the process. Says whether
/// the input was taken.
bool taken(const std::string& what, void (*use)(const std::string&));

/// Ends the process where a number that the program goes on with is not finite.
void require_finite(double value);

/// Numbers from an input, zeros beyond its end.
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
  /// 0 to count - 1.
  unsigned below(unsigned count) { return take<std::uint8_t>() % count; }

 private:
  const std::uint8_t *next_, *end_;
};

/// What a first line "# word" says: which reader the text is for. Both scene files and tables take
/// such a line as a comment.
std::string first_line(std::string_view text);

}  // namespace flatspeckle::fuzz

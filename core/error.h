#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace flatspeckle {

/// What the user gave cannot be used: a scene key, a flag, a file. The program prints the one line
/// and exits with status 2, having written nothing.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}

  /// "key = value: accepted", e.g. "width = -3: must be positive".
  template <typename Value>
  InputError(const std::string& key, const Value& value, const std::string& accepted)
      : std::runtime_error(line(key, value, accepted)) {}

 private:
  template <typename Value>
  static std::string line(const std::string& key, const Value& value, const std::string& accepted) {
    std::ostringstream text;
    text << key << " = " << value << ": " << accepted;
    return text.str();
  }
};

/// Reading or writing failed though the input was right (disk full, folder vanished). Exit
/// status 4.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace flatspeckle

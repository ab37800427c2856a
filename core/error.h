#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace flatspeckle {

/// Exception for unusable input: a wrong scene key, flag or file. The program prints the message as
/// one line and exits with status 2 without writing a result.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}

  /// Makes the message "key = value: accepted", e.g. "width = -3: must be positive".
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

/// Exception for a failure to read or write although the input is valid (disk full, folder
/// removed). The program exits with status 4.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace flatspeckle

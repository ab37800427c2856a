#pragma once

#include <string>

#include "core/error.h"
#include "core/keys/keys.h"

namespace flatspeckle::grin {

/// Returns read(path), where `path` is the value of a key. If read() throws an InputError, adds the
/// names of the key and the file to its message.
template <class Read>
auto read_field(const Keys& keys, const std::string& path, const Read& read) {
  try {
    return read(path);
  } catch (const InputError& error) {
    const std::string message = error.what();
    const bool names = message.find(path) != std::string::npos;
    throw InputError(keys.name(path) + ": " + (names ? "" : path + ": ") + message);
  }
}

}  // namespace flatspeckle::grin

#pragma once

#include <string>

#include "core/error.h"
#include "core/keys/keys.h"

namespace flatspeckle::grin {

/// What read(path) makes of the file that a key names; what it throws as InputError names key and
/// file.
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

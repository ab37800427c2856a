#include "core/session/aside.h"

#include <string>

namespace flatspeckle {

std::filesystem::path free_aside(const std::filesystem::path& path) {
  for (int number = 1;; ++number) {
    const std::filesystem::path place = path.string() + ".aside-" + std::to_string(number);
    if (!std::filesystem::exists(place)) return place;
  }
}

}  // namespace flatspeckle

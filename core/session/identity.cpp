#include "core/session/identity.h"

#include <set>
#include <sstream>

namespace flatspeckle {

std::string first_difference(const std::string& there, const std::string& here) {
  std::istringstream ours(here), lines(there);
  std::set<std::string> known;
  for (std::string line; std::getline(ours, line);) known.insert(line);
  for (std::string line; std::getline(lines, line);)
    if (!known.contains(line)) return line;
  return "fewer keys";
}

}  // namespace flatspeckle

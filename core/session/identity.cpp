#include "core/session/identity.h"

#include <set>
#include <sstream>

#include "core/result/file_checksum.h"

namespace flatspeckle {

std::string first_difference(const std::string& there, const std::string& here) {
  std::istringstream ours(here), lines(there);
  std::set<std::string> known;
  for (std::string line; std::getline(ours, line);) known.insert(line);
  for (std::string line; std::getline(lines, line);)
    if (!known.contains(line)) return line;
  return "fewer keys";
}

std::string inputs_text(const Keys& keys) {
  std::string text;
  for (const std::string& path : keys.files())
    text += path + ' ' + std::to_string(file_checksum(path)) + '\n';
  return text;
}

}  // namespace flatspeckle

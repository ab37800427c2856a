#pragma once

#include <string>
#include <vector>

namespace flatspeckle::apps {

/// A key of a scene file and its values, written as on the command line.
struct SceneEntry {
  std::string key;
  std::vector<std::string> values;
};

/// Parses a scene file in TOML: keys (not in tables) whose values are texts, numbers, true, false
/// or lists of these. Throws InputError, whose message gives the line number.
std::vector<SceneEntry> read_scene(const std::string& text);

}  // namespace flatspeckle::apps

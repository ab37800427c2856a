#pragma once

#include <string>
#include <vector>

namespace flatspeckle::apps {

/// A key of a scene file and its values, written as on the command line.
struct SceneEntry {
  std::string key;
  std::vector<std::string> values;
};

/// Reads TOML: one flat list of keys, whose values are texts, numbers, true, false or lists of
/// these. Throws InputError naming the line.
std::vector<SceneEntry> read_scene(const std::string& text);

}  // namespace flatspeckle::apps

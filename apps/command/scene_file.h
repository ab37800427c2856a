#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace flatspeckle::apps {

/// Scene files: one flat list of `key = value` lines of TOML. CLI11's own reader, behind
/// checks for what that reader takes without a word: lists that are not closed, tables, keys that
/// are given twice or without a value, stray text. It is given one key at a time, lists on one
/// line.
class SceneFile : public CLI::ConfigTOML {
 public:
  SceneFile();

  /// Throws InputError naming the line.
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;

 private:
  CLI::ConfigItem item(const std::string& statement) const;
};

}  // namespace flatspeckle::apps

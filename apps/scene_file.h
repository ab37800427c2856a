#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace flatspeckle::apps {

/// Scene files: one flat list of `key = value` lines of TOML. CLI11's own reader and writer, behind
/// checks for what that reader takes without a word: lists that are not closed, tables, keys that
/// are given twice or without a value, stray text. It is given one key at a time, lists on one
/// line.
class SceneFile : public CLI::ConfigTOML {
 public:
  SceneFile();

  /// The options of an app, lists always as lists; those without a value or default are left out.
  std::string to_config(const CLI::App* app, bool, bool, std::string) const override;
  /// Throws InputError naming the line.
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;

 private:
  CLI::ConfigItem item(const std::string& statement) const;
};

}  // namespace flatspeckle::apps

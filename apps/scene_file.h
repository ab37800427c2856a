#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace flatspeckle::apps {

/// Scene files: one flat list of `key = value` lines of TOML. A value is a number, true, false, a
/// "string" or 'string', or a [list] of these, which may go over several lines; '#' starts a
/// comment. CLI11's own reader would take an unclosed list or a key that is given twice without a
/// word.
class SceneFile : public CLI::Config {
 public:
  /// The options of an app, lists always as lists; those without a value or default are left out.
  std::string to_config(const CLI::App* app, bool, bool, std::string) const override;
  /// Throws InputError naming the line.
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;
};

/// The lines of a configuration that to_config wrote less some keys: what makes two runs the same.
std::string without_keys(const std::string& config, const std::vector<std::string>& keys);

}  // namespace flatspeckle::apps

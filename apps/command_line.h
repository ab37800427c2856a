#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/options.h"

namespace flatspeckle::apps {

/// argv of the program; [1] is the subcommand.
using Arguments = std::vector<std::string>;

/// What the command line settles before any work is done.
struct CommandLine {
  std::string config;  ///< resolved, as TOML; give it to --config to run the same again
  std::string text;    ///< as typed
};

/// The parser of a subcommand: a scene file (--config) holds the flags as flat keys, a flag beats
/// the file, unknown keys are errors.
class Subcommand {
 public:
  Subcommand(const std::string& name, const std::string& purpose);
  ~Subcommand();

  Options& options() { return options_; }

  /// Throws InputError for what cannot be parsed. --help and --print-config print and return false.
  bool parse(const Arguments& arguments);
  /// The same for a resolved configuration alone.
  void parse_config(const std::string& config);
  const CommandLine& command_line() const { return command_line_; }
  /// Whether a key was given, in the file or as a flag.
  bool given(const std::string& key) const;

 private:
  void parse_by(const std::function<void()>& parser);

  std::unique_ptr<CLI::App> app_;
  Options options_;
  bool print_config_ = false;
  CommandLine command_line_;
};

/// The lines of a resolved configuration less those of some keys.
std::string without_keys(const std::string& config, const std::vector<std::string>& keys);

}  // namespace flatspeckle::apps

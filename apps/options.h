#pragma once

#include <string>

namespace CLI {
class App;
}

namespace flatspeckle::apps {

/// The keys of a subcommand, on the command line and in scene files, and where their values go. A
/// Value is a number, a text, a list of either, or optional; options.cpp has which. CLI11 behind a
/// header that costs nothing to include.
class Options {
 public:
  explicit Options(CLI::App& app) : app_(app) {}

  template <typename Value>
  void add(const std::string& flag, Value& value, const std::string& description);
  /// Its present value stands in --help, and in the resolved scene if the key is not given.
  template <typename Value>
  void add_with_default(const std::string& flag, Value& value, const std::string& description);
  void add_flag(const std::string& flag, bool& value, const std::string& description);

  void describe(const std::string& flag, const std::string& description);
  void keep_out_of_scene_file(const std::string& flag);
  void remove(const std::string& flag);

 private:
  CLI::App& app_;
};

}  // namespace flatspeckle::apps

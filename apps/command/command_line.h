#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"

namespace CLI {
class App;
}

namespace flatspeckle::apps {

/// Arguments of the command line (argv): [0] is the program, [1] the subcommand.
using Arguments = std::vector<std::string>;

/// Parser of the command line of a subcommand. Its flags, the keys of its scene file, its help and
/// the resolved scene all follow from the key definitions. A scene file (--config) contains the
/// flags as keys without tables. Flags override the scene file; unknown keys are errors.
class Subcommand {
 public:
  Subcommand(std::string name, std::string purpose);
  ~Subcommand();

  Keys& keys() { return keys_; }
  const Keys& keys() const { return keys_; }
  /// Returns all keys, including length_unit, which is added here if any key is a length. To be
  /// called after all other keys are added.
  const Keys& all_keys();

  /// Makes parse() store the words before the flags, such as FILE in `explain FILE`, in `words`.
  void take_words(std::vector<std::string>& words) { words_ = &words; }

  /// Sets the variables of all keys and checks their values. Returns false if there is nothing more
  /// to do, for example after --help. Throws InputError.
  bool parse(const Arguments& arguments);
  /// Like parse(), but reads the text of a scene file instead of command-line arguments.
  void parse_config(const std::string& config);

  /// Throws InputError if a key is given that no code has read. To be called after everything has
  /// been made from the keys. With --print-config, prints the resolved scene and returns false.
  bool settle() const;
  /// Whether --print-config is given, so that settle() will only print the resolved scene.
  bool only_prints() const { return print_config_; }

  /// Returns the command line as typed.
  const std::string& text() const { return text_; }

 private:
  void add_length_unit();
  Arguments flags_of(const Arguments& arguments);
  void add_flags();
  std::vector<std::string> results_of(const Key& key) const;
  std::optional<double> take_length_unit();
  std::string in_numbers(const Key& key, const std::string& text,
                         const std::optional<double>& metres) const;
  void take_results();
  void print_help() const;
  template <typename Parser>
  void parse_by(const Parser& parser);

  std::string name_, purpose_, text_;
  std::vector<std::string>* words_ = nullptr;
  std::unique_ptr<CLI::App> app_;
  Keys keys_;
  std::optional<double> length_unit_;
  bool print_config_ = false;
};

/// Adds the key length_unit. The subcommand adds it by itself if any key is a length; an experiment
/// whose result depends on it adds it to its own keys.
void add_length_unit_key(Keys& keys, std::optional<double>& metres);

/// Returns the value of a key before the other keys are defined, for the key `of`, on which the set
/// of other keys depends. The value is taken from the flags or from the scene file named by
/// --config; it is empty if the key is not given. Errors are ignored here; Subcommand::parse()
/// reports them.
std::string value_ahead(const std::string& key, const Arguments& arguments);
/// Returns the value of a key in the text of a scene file; empty if it is not given.
std::string value_in(const std::string& key, const std::string& config);

}  // namespace flatspeckle::apps

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

/// argv of the program; [1] is the subcommand.
using Arguments = std::vector<std::string>;

/// The parser of a subcommand: flags, scene file, help and resolved scene, all by the rows of its
/// keys. A scene file (--config) holds the flags as flat keys, a flag beats the file, unknown keys
/// are errors.
class Subcommand {
 public:
  Subcommand(std::string name, std::string purpose);
  ~Subcommand();

  Keys& keys() { return keys_; }
  const Keys& keys() const { return keys_; }
  /// With those that follow from others, once these are added.
  const Keys& all_keys();

  /// Binds what stands before the flags to a text, as `explain FILE` has it.
  void take_word(std::string& word) { word_ = &word; }

  /// Fills the members of the keys and checks what their rows accept. Throws InputError. False
  /// where there is no more to do: after --help and the like.
  bool parse(const Arguments& arguments);
  /// The same for the text of a scene file alone.
  void parse_config(const std::string& config);

  /// After all that is asked for has been made of the keys: throws InputError for those that
  /// nothing read. False where no more is wanted than the resolved scene (--print-config).
  bool settle() const;
  /// Before that: whether it is.
  bool only_prints() const { return print_config_; }

  /// As typed.
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
  std::string* word_ = nullptr;
  std::unique_ptr<CLI::App> app_;
  Keys keys_;
  std::optional<double> length_unit_;
  bool print_config_ = false;
};

/// The value of a key that says which others there are, from the flags or the scene file that they
/// name; empty where it is not given. What else is wrong shows when all is parsed.
std::string value_ahead(const std::string& key, const Arguments& arguments);
/// Returns the same from the text of a scene file.
std::string value_in(const std::string& key, const std::string& config);

}  // namespace flatspeckle::apps

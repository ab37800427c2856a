#include "apps/command/command_line.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/command/key_lists.h"
#include "apps/command/odd_values.h"
#include "apps/command/scene_file.h"
#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/keys/key.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"
#include "grin/render/values/mcx_scene.h"

namespace flatspeckle::apps {

namespace {

/// Keys whose values are names of input files although Key::is_file() is false. The code that reads
/// these files checks that they exist.
const std::set<std::string> also_files{"compare",     "measurement", "near_sensors", "near_sources",
                                       "phase_table", "points",      "points_table"};
/// Keys whose value is either one of several words or the name of an input file.
const std::set<std::string> words_or_files{"placement", "structure"};

/// Whether the value of a key in a scene file is the path of a file that the program reads.
bool names_a_file(const Key& key, const std::string& value) {
  if (key.is_file() || key.is_number()) return key.is_file();
  // the key `structure` of the subcommand `place` names an output file
  const bool is_output = key.help().starts_with("Result file");
  return also_files.contains(key.name()) || (words_or_files.contains(key.name()) && !is_output &&
                                             value.find_first_of("./") != std::string::npos);
}

/// Parser of scene files, as CLI11 requires it. A file in JSON is an MCX scene. Relative paths of
/// input files are searched in the folder of the scene file first, then in the working folder.
class SceneFile : public CLI::Config {
 public:
  SceneFile() = default;
  /// keys: definitions of the keys, which also determine whose values are paths of input files.
  SceneFile(const Keys& keys, const CLI::App& app) : keys_(&keys), app_(&app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::string text;
    try {
      text.assign(std::istreambuf_iterator<char>(input), {});
    } catch (const std::ios_base::failure&) {
      throw InputError("cannot be read");
    }
    std::vector<CLI::ConfigItem> found;
    if (const auto start = text.find_first_not_of(" \t\r\n");
        start != std::string::npos && text[start] == '{') {
      for (auto& [key, values] : grin::mcx_keys(app_->get_config_ptr()->as<std::string>()))
        found.push_back({{}, std::move(key), std::move(values)});
      return found;
    }
    for (auto& [key, values] : read_scene(text)) {
      const Key* const row = keys_ == nullptr ? nullptr : keys_->find(key);
      for (std::string& value : values)
        if (row != nullptr && names_a_file(*row, value)) value = beside_the_scene(value);
      found.push_back({{}, std::move(key), std::move(values)});
    }
    return found;
  }
  /// Required by the base class, but not used.
  std::string to_config(const CLI::App*, bool, bool, std::string) const override { return ""; }

  /// Throws InputError if a file named in the scene exists neither in the scene's folder nor in the
  /// working folder.
  void require_files() const {
    if (missing_.empty()) return;
    for (const Key& key : keys_->rows())
      for (const std::string& value : key.value())
        if (missing_.contains(value) && names_a_file(key, value))
          throw InputError(key.name(), value,
                           "no such file in " + std::filesystem::absolute(folder()).string() +
                               ", the folder of the scene, nor in the working folder " +
                               std::filesystem::current_path().string());
  }

 private:
  std::filesystem::path folder() const {
    const auto file = std::filesystem::path(app_->get_config_ptr()->as<std::string>());
    return file.has_parent_path() ? file.parent_path() : ".";
  }

  /// Returns the path of a file named in the scene: the path in the folder of the scene file if the
  /// file exists there, otherwise the given path, which is relative to the working folder.
  std::string beside_the_scene(const std::string& value) const {
    std::error_code none;
    const std::filesystem::path path = value, beside = (folder() / path).lexically_normal();
    if (path.is_absolute() || app_->get_config_ptr()->empty()) return value;
    if (std::filesystem::exists(beside, none)) return beside.string();
    if (!std::filesystem::exists(path, none)) missing_.insert(value);
    return value;
  }

  const Keys* keys_ = nullptr;
  const CLI::App* app_ = nullptr;
  /// Files named in the scene that exist neither in the folder of the scene file nor in the working
  /// folder.
  mutable std::set<std::string> missing_;
};

/// Throws InputError for a number with very many digits, which would make unit parsing and
/// libraries slow.
void refuse_long_numbers(const std::string& key, const std::string& text) {
  constexpr std::size_t most = 400;
  std::size_t figures = 0;
  for (const char letter : text) {
    figures = letter == '.' || std::isdigit(static_cast<unsigned char>(letter)) ? figures + 1 : 0;
    if (figures > most)
      throw InputError(key, text.substr(0, 20) + "...",
                       "a number must have at most " + std::to_string(most) + " digits");
  }
}

/// Returns the length that a text such as "um", "0.5mm" or "1e-6" means, in metres; nullopt for any
/// other text.
std::optional<double> metres_of(const std::string& text) {
  const KeyUnit metres("m");
  const auto unit = unit_of(text);
  return unit && metres.accepts(*unit) ? unit->size : written_number(text, metres);
}

constexpr const char* length_unit_key = "length_unit";
/// Keys whose values assign values to other keys, as in --vary depth=10um:1mm.
const std::set<std::string> assigning{"vary", "free", "against"};
/// Keys of earlier versions, with a text for the error message about what replaces them.
const std::map<std::string, std::string> gone{
    {"photon_radius", "; the photon map is a baseline of `bench error`"},
    {"rate", "; the search adam is a baseline of `bench error`"}};

/// Returns "0-.4" for the number -.4 and "0-pi" for -pi, because CLI11 would parse these arguments
/// as flags "." and "p".
std::string with_figure(const std::string& argument) {
  const bool is_pi =
      argument.starts_with("-pi") &&
      (argument.size() == 3 || !std::isalpha(static_cast<unsigned char>(argument[3])));
  const bool number = is_pi || argument.starts_with("-.");
  return number ? "0" + argument : argument;
}

/// Returns the arguments after the subcommand in reverse order, as CLI11 requires.
Arguments reversed(const Arguments& arguments) {
  Arguments flags;
  std::transform(arguments.rbegin(), arguments.rend() - 2, std::back_inserter(flags), with_figure);
  return flags;
}

std::string line_of(const Arguments& arguments) {
  std::string text;
  for (const auto& argument : arguments) {
    const bool plain =
        argument.find_first_of(" \"'$\\*?[]") == std::string::npos && !argument.empty();
    text += (text.empty() ? "" : " ") + (plain ? argument : "'" + argument + "'");
  }
  return text;
}

/// Alternatives to keys that some subcommands do not have, and to names of other renderers.
const std::map<std::string, std::string> alternatives{
    {"medium_index",
     "; pictures of speckle behind reflecting faces: image --dimension 3 with one point"},
    {"spp", "; see samples_per_pixel of render"},
    {"fov", "; see field_of_view of render, the full angle of a row in radians"},
    {"envmap", "; see environment_map of render"}};

std::string unknown_key(const Keys& keys, const std::string& name) {
  if (gone.contains(name)) return name + ": unknown key" + gone.at(name);
  const auto owners = key_owners();
  const auto owner = owners.find(name);
  const std::string advice = owner == owners.end()
                                 ? did_you_mean(keys, name)
                                 : "; it is a key of " + join_texts(owner->second, ", ");
  const auto alternative = alternatives.find(name);
  return name + ": unknown key" + advice +
         (alternative == alternatives.end() ? "" : alternative->second) +
         " (--help lists all keys)";
}

/// Converts an error of CLI11 to a one-line message in the form of this program's messages.
std::string explain(const Keys& keys, const CLI::App& app, const CLI::ParseError& error) {
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  const std::string unknown_in_file = "INI was not able to parse ";
  if (message.starts_with(unknown_in_file))
    return app.get_config_ptr()->as<std::string>() + ", " +
           unknown_key(keys, message.substr(unknown_in_file.size()));
  if (dynamic_cast<const CLI::FileError*>(&error) != nullptr) return "config: " + message;
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const bool many = message.find("At Most") != std::string::npos;
    return message.substr(2, message.find(':') - 2) +
           (many ? ": must have one value and be given once" : ": must have a value");
  }
  return message;
}

void refuse_strays(const Keys& keys, const std::vector<std::string>& strays) {
  if (strays.empty()) return;
  const std::string& word = strays.front();
  if (word.starts_with("--"))
    throw InputError(unknown_key(keys, word.substr(2, word.find('=') - 2)));
  throw InputError(word + ": does not belong to a key; expected --key value" +
                   (word.ends_with(".toml") ? " (for a scene file: --config FILE)"
                                            : " (switches take no value, most keys only one)"));
}

}  // namespace

Subcommand::Subcommand(std::string name, std::string purpose)
    : name_(std::move(name)),
      purpose_(std::move(purpose)),
      app_(std::make_unique<CLI::App>(purpose_, "flatspeckle " + name_)) {
  app_->set_config("--config");
  app_->allow_config_extras(CLI::config_extras_mode::error);
  app_->config_formatter(std::make_shared<SceneFile>(keys_, *app_));
  app_->allow_extras();  // unknown arguments are rejected later, with a clearer message
  app_->add_flag("--print-config", print_config_)->configurable(false);
}

Subcommand::~Subcommand() = default;

void add_length_unit_key(Keys& keys, std::optional<double>& metres) {
  keys.group("Units");
  keys.add(length_unit_key, metres,
           "Unit of lengths that are given without a unit: um, or 1e-6 (metres); required if any "
           "length is given with a unit, such as 532nm")
      .positive()
      .unit("m")
      .effort();
}

/// Adds the key length_unit if any key is a length and the subcommand does not define length_unit
/// itself.
void Subcommand::add_length_unit() {
  const auto& rows = keys_.rows();
  const bool lengths =
      std::any_of(rows.begin(), rows.end(), [](const Key& key) { return key.unit() == "length"; });
  if (!lengths || keys_.find(length_unit_key) != nullptr) return;
  add_length_unit_key(keys_, length_unit_);
  keys_.read(length_unit_);
}

/// Adds a flag for each key name; several definitions may share a name.
void Subcommand::add_flags() {
  std::set<std::string> names;
  for (const Key& key : keys_.rows()) {
    if (!names.insert(key.name()).second) continue;
    const std::string flag = "--" + key.name();
    CLI::Option* const option =
        key.is_switch() ? app_->add_flag(flag)
                        : app_->add_option(flag, CLI::callback_t([](const auto&) { return true; }));
    if (key.is_list())
      option->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args();
    option->configurable(key.is_in_files());
  }
}

/// Returns the given values of a key. If a flag has no value, CLI11 takes the next flag as its
/// value; this is rejected here.
std::vector<std::string> Subcommand::results_of(const Key& key) const {
  const CLI::Option* const option = app_->get_option("--" + key.name());
  for (const std::string& value : option->results()) {
    if (value.empty() || value.starts_with("--"))
      throw InputError(key.name(), '"' + value + '"', "must have a value");
    refuse_long_numbers(key.name(), value);
  }
  return option->results();
}

/// Returns the value of the key length_unit in metres; nullopt if it is not given.
std::optional<double> Subcommand::take_length_unit() {
  const Key* const key = keys_.find(length_unit_key);
  if (key == nullptr) return std::nullopt;
  const auto given = results_of(*key);
  if (given.empty()) return std::nullopt;
  const auto metres = metres_of(given.back());
  if (!metres)
    throw InputError(
        key->name(), given.back(),
        "must be um, mm or another unit, a length such as 0.5um, or a number of metres");
  keys_.set(key->name(), {number_text(*metres)});
  return metres;
}

/// Returns a value such as depth=10um:1mm, which assigns values to another key, with the numbers in
/// the unit of that key; returns the values of other keys unchanged.
std::string Subcommand::in_numbers(const Key& key, const std::string& text,
                                   const std::optional<double>& metres) const {
  const auto equals = text.find('=');
  if (!assigning.contains(key.name()) || equals == std::string::npos) return text;
  const std::string name = text.substr(0, equals);
  const auto dot = std::min(name.find('.'), name.size());
  const Key* const other = keys_.find(name.substr(0, dot));
  if (other == nullptr) return text;
  const auto position = read_whole_number(name.substr(std::min(dot + 1, name.size())));
  const KeyUnit unit = other->number_unit(metres, static_cast<std::size_t>(position.value_or(0)));
  return text.substr(0, equals + 1) + without_units(text.substr(equals + 1), unit);
}

void Subcommand::take_results() {
  const auto metres = take_length_unit();
  for (const Key& key : keys_.rows()) {
    auto given = results_of(key);
    if (given.empty() || key.name() == length_unit_key) continue;
    for (std::string& text : given) text = in_numbers(key, text, metres);
    try {
      key.set(given, metres);
    } catch (const InputError& error) {
      const std::string table = key.name() + "_table";
      if (keys_.find(table) == nullptr) throw;
      throw InputError(error.what() + ("; to give a table, use the key " + table));
    }
  }
}

/// Runs a parser of CLI11, then sets the variables of the keys and checks their values. Errors of
/// CLI11 are converted to InputError; the exception CLI::CallForHelp is passed on.
template <typename Parser>
void Subcommand::parse_by(const Parser& parser) {
  add_flags();
  try {
    parser();
  } catch (const CLI::CallForHelp&) {
    throw;
  } catch (const CLI::ParseError& error) {
    throw InputError(explain(keys_, *app_, error));
  }
  take_results();
  refuse_strays(keys_, app_->remaining());
  dynamic_cast<const SceneFile&>(*app_->get_config_formatter()).require_files();
  keys_.check();
}

const Keys& Subcommand::all_keys() {
  add_length_unit();
  return keys_;
}

/// Returns the arguments in reverse order, as CLI11 requires, without the words before the first
/// flag, which are stored in *words_.
Arguments Subcommand::flags_of(const Arguments& arguments) {
  Arguments flags = reversed(arguments);
  for (; words_ != nullptr && !flags.empty() && !flags.back().starts_with('-'); flags.pop_back())
    words_->push_back(flags.back());
  return flags;
}

bool Subcommand::parse(const Arguments& arguments) {
  add_length_unit();
  const Arguments own = flags_of(arguments);
  const auto parser = [&] {
    try {
      app_->parse(Arguments(own));
    } catch (const InputError& error) {  // the error is in the scene file
      throw InputError(app_->get_config_ptr()->as<std::string>() + ", " + error.what());
    }
  };
  try {
    parse_by(parser);
  } catch (const CLI::CallForHelp&) {
    print_help();
    return false;
  }
  text_ = line_of(arguments);
  return true;
}

void Subcommand::parse_config(const std::string& config) {
  add_length_unit();
  std::istringstream text(config);
  parse_by([&] { app_->parse_from_stream(text); });
}

bool Subcommand::settle() const {
  keys_.refuse_unread();
  if (print_config_)
    std::cout << keys_.config();
  else
    note_odd_values(keys_);
  return !print_config_;
}

void Subcommand::print_help() const {
  std::printf("%s\nUsage: flatspeckle %s [--config SCENE.toml] [--key value ...]%s\n\n",
              purpose_.c_str(), name_.c_str(), keys_.find("out") ? " --out FILE" : "");
  print_help_lines(keys_);
  std::puts(
      "\nProgram:\n"
      "  -h,--help                       Print this help and exit\n"
      "  --config FILE                   Scene file: these flags as keys, one per line (TOML)\n"
      "  --print-config                  Check all keys, print the resolved scene and exit");
}

std::string value_ahead(const std::string& key, const Arguments& arguments) {
  CLI::App app;
  app.set_help_flag();
  app.set_config("--config");
  app.config_formatter(std::make_shared<SceneFile>());
  app.allow_config_extras(CLI::config_extras_mode::ignore_all);
  app.allow_extras();
  std::string value;
  app.add_option("--" + key, value);
  try {
    app.parse(reversed(arguments));
  } catch (const CLI::ParseError&) {
  } catch (const InputError&) {
  }
  return value;
}

std::string value_in(const std::string& key, const std::string& config) {
  for (const auto& [name, values] : read_scene(config))
    if (name == key && values.size() == 1) return values.front();
  return "";
}

}  // namespace flatspeckle::apps

#include "apps/command_line.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <iostream>
#include <memory>
#include <sstream>

#include <CLI/CLI.hpp>

#include "apps/scene_file.h"
#include "core/error.h"

namespace flatspeckle::apps {

namespace {

std::string joined(const Arguments& arguments) {
  std::string text;
  for (const auto& argument : arguments) {
    const bool plain =
        argument.find_first_of(" \"'$\\*?[]") == std::string::npos && !argument.empty();
    text += (text.empty() ? "" : " ") + (plain ? argument : "'" + argument + "'");
  }
  return text;
}

std::string accepted_by(const CLI::App& app, const std::string& message) {
  for (const CLI::Option* option : app.get_options()) {
    if (message.find(option->get_name() + " =") == std::string::npos) continue;
    const std::string type = option->get_type_name();
    if (type.find("FLOAT") != std::string::npos) return ": must be a number";
    if (type.find("INT") != std::string::npos) return ": must be a whole number";
  }
  return "";
}

/// CLI11's message as one line in this program's words.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  const std::string unknown_in_file = "INI was not able to parse ";
  if (message.starts_with(unknown_in_file))
    return app.get_config_ptr()->as<std::string>() + ", " + message.substr(unknown_in_file.size()) +
           ": unknown key (--help lists the known ones)";
  const std::string not_converted = "Could not convert: --";
  if (message.starts_with(not_converted))
    return message.substr(not_converted.size()) + accepted_by(app, message);
  if (dynamic_cast<const CLI::FileError*>(&error) != nullptr) return "config: " + message;
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const bool many = message.find("At Most") != std::string::npos;
    return message.substr(2, message.find(':') - 2) +
           (many ? ": must have one value, and be given once" : ": must have a value");
  }
  return message;
}

/// Numbers in the shortest form that reads back as the same one: 20.0 and 2e1 are 20.
std::string shortest(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc{} || read.ptr != end) return text;
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

bool is_odd(unsigned char c) {
  return std::iscntrl(c) != 0 || c == '"' || c == '\\';
}

/// CLI11 lets a text option take the flag that follows it, a whole number that is too large become
/// the largest one, and writes texts without escapes.
void refuse_odd_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& value : option->results()) {
      const std::string name = option->get_single_name();
      if (value.empty() || value.starts_with("--"))
        throw InputError(name, '"' + value + '"', "must have a value");
      if (std::any_of(value.begin(), value.end(), is_odd))
        throw InputError(name, value, "must be without control characters, \" and \\");
      std::int64_t number = 0;
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
      if (option->get_type_name() == "INT" && error == std::errc::result_out_of_range)
        throw InputError(name, value, "must be a whole number of at most 18 digits");
    }
  }
}

void refuse_strays(const std::vector<std::string>& strays) {
  if (strays.empty()) return;
  const std::string& word = strays.front();
  if (word.starts_with("--"))
    throw InputError(word.substr(2, word.find('=') - 2) +
                     ": unknown key (--help lists the known ones)");
  throw InputError(word + ": stands alone; expected --key value" +
                   (word.ends_with(".toml") ? " (of a scene file: --config FILE)"
                                            : " (switches have none, most keys only one)"));
}

}  // namespace

Subcommand::Subcommand(const std::string& name, const std::string& purpose)
    : app_(std::make_unique<CLI::App>(purpose, "flatspeckle " + name)), options_(*app_) {
  app_->set_config("--config", "", "Scene file: these flags as keys, one a line (TOML)");
  app_->allow_config_extras(CLI::config_extras_mode::error);
  app_->config_formatter(std::make_shared<SceneFile>());
  app_->allow_extras();  // refused below, in clearer words
  app_->add_flag("--print-config", print_config_, "Print the resolved scene and exit")
      ->configurable(false);
  app_->get_formatter()->column_width(34);
}

Subcommand::~Subcommand() = default;

bool Subcommand::given(const std::string& key) const {
  return app_->get_option("--" + key)->count() > 0;
}

/// Turns CLI11's complaints into ours; CallForHelp passes.
void Subcommand::parse_by(const std::function<void()>& parser) {
  for (CLI::Option* option : app_->get_options())
    if (option->get_type_name() == "FLOAT") option->transform(shortest);
  try {
    parser();
  } catch (const CLI::CallForHelp&) {
    throw;
  } catch (const CLI::ParseError& error) {
    throw InputError(explain(*app_, error));
  }
  refuse_odd_values(*app_);
  refuse_strays(app_->remaining());
}

bool Subcommand::parse(const Arguments& arguments) {
  std::vector<std::string> own(arguments.rbegin(), arguments.rend() - 2);
  const auto parser = [&] {
    try {
      app_->parse(own);
    } catch (const InputError& error) {  // from the scene file
      throw InputError(app_->get_config_ptr()->as<std::string>() + ", " + error.what());
    }
  };
  try {
    parse_by(parser);
  } catch (const CLI::CallForHelp&) {
    std::cout << app_->help();
    return false;
  }
  command_line_ = {app_->config_to_str(), joined(arguments)};
  if (print_config_) std::cout << command_line_.config;
  return !print_config_;
}

void Subcommand::parse_config(const std::string& config) {
  std::istringstream text(config);
  parse_by([&] { app_->parse_from_stream(text); });
  command_line_.config = app_->config_to_str();
}

std::string without_keys(const std::string& config, const std::vector<std::string>& keys) {
  std::istringstream lines(config);
  std::string kept, line;
  while (std::getline(lines, line)) {
    const std::string key = line.substr(0, line.find(" = "));
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) kept += line + '\n';
  }
  return kept;
}

}  // namespace flatspeckle::apps

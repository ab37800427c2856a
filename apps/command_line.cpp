#include "apps/command_line.h"

#include <algorithm>
#include <iostream>
#include <sstream>

#include "core/error.h"

namespace flatspeckle::apps {

namespace {

std::string joined(const Arguments& arguments) {
  std::string text;
  for (const auto& argument : arguments) {
    const bool plain = argument.find_first_of(" \"'$\\*?[]") == std::string::npos && !argument.empty();
    text += (text.empty() ? "" : " ") + (plain ? argument : "'" + argument + "'");
  }
  return text;
}

std::string key_of(const std::string& line) { return line.substr(0, line.find('=')); }

/// Options that were not given and have no default are written as key=""; they say nothing.
std::string without_empty(const std::string& config) {
  std::istringstream lines(config);
  std::string kept, line;
  while (std::getline(lines, line))
    if (!line.empty() && line.substr(key_of(line).size()) != "=\"\"") kept += line + '\n';
  return kept;
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
  if (message.starts_with(unknown_in_file)) {
    const std::string key = message.substr(unknown_in_file.size());
    return key.substr(0, key.find(".++")) + ": unknown key (--help lists the known ones)";
  }
  const std::string not_converted = "Could not convert: --";
  if (message.starts_with(not_converted))
    return message.substr(not_converted.size()) + accepted_by(app, message);
  return message;
}

void refuse_empty_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0 && !option->results().empty() && option->results().front().empty())
      throw InputError(option->get_name(false, true).substr(2) + " = \"\": must have a value");
}

}  // namespace

Subcommand::Subcommand(const std::string& name, const std::string& purpose)
    : app_(purpose, "flatspeckle " + name) {
  app_.set_config("--config", "", "Scene file: these flags as keys, one a line (TOML)");
  app_.allow_config_extras(CLI::config_extras_mode::error);
  app_.add_flag("--print-config", print_config_, "Print the resolved scene and exit")
      ->configurable(false);
  app_.get_formatter()->column_width(34);
}

bool Subcommand::parse(const Arguments& arguments) {
  std::vector<std::string> own(arguments.rbegin(), arguments.rend() - 2);
  try {
    app_.parse(own);
  } catch (const CLI::CallForHelp&) {
    std::cout << app_.help();
    return false;
  } catch (const CLI::ParseError& error) {
    throw InputError(explain(app_, error));
  }
  refuse_empty_values(app_);
  command_line_ = {without_empty(app_.config_to_str(true, false)), joined(arguments)};
  if (print_config_) std::cout << command_line_.config;
  return !print_config_;
}

std::string without_keys(const std::string& config, const std::vector<std::string>& keys) {
  std::istringstream lines(config);
  std::string kept, line;
  while (std::getline(lines, line))
    if (std::find(keys.begin(), keys.end(), key_of(line)) == keys.end()) kept += line + '\n';
  return kept;
}

}  // namespace flatspeckle::apps

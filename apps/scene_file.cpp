#include "apps/scene_file.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>

#include "core/error.h"

namespace flatspeckle::apps {

namespace {

constexpr const char* delimiter = " = ";

bool is_binary(unsigned char c) {
  return std::iscntrl(c) != 0 && std::isspace(c) == 0;
}

/// Appends a line of a file less its comment.
void append(const std::string& line, std::string& statement, bool& in_list) {
  char quote = '\0';
  for (const char c : line) {
    if (quote == '\0' && c == '#') break;
    if (quote != '\0' || c == '"' || c == '\'') {
      quote = quote == '\0' ? c : quote == c ? '\0' : quote;
    } else if (c == '[' || c == ']') {
      if (in_list == (c == '[')) throw InputError("brackets do not match; a list is [a, b]");
      in_list = !in_list;
    } else if (c == ',') {
      CLI::detail::rtrim(statement);  // CLI11 would read "1 ," as the text "1 "
    }
    statement += c;
  }
  if (quote != '\0') throw InputError(std::string("a text is not closed by ") + quote);
  statement += ' ';
}

/// Names and values less all that stands between them.
std::string content(std::string text) {
  constexpr std::string_view between = " \t\r\f\v\"'[],=";
  std::erase_if(text, [&](char c) { return between.find(c) != std::string_view::npos; });
  return text;
}

}  // namespace

SceneFile::SceneFile() {
  comment('\n');  // CLI11 would cut a text in quotes at its #
}

CLI::ConfigItem SceneFile::item(const std::string& statement) const {
  std::istringstream input(statement);
  const auto read = CLI::ConfigTOML::from_config(input);
  const bool one = read.size() == 1 && std::isalpha(static_cast<unsigned char>(read[0].name[0]));
  if (!one || content(read[0].name + CLI::detail::join(read[0].inputs, "")) != content(statement))
    throw InputError("expected key = value or key = [a, b], without [tables]");
  if (read[0].inputs.empty() || CLI::detail::find_member("", read[0].inputs) >= 0)
    throw InputError(read[0].name + ": must have a value");
  if (read[0].inputs.size() > 1 && statement.find('[') == std::string::npos)
    throw InputError(read[0].name + ": expected one value; a list is [a, b]");
  return read[0];
}

std::vector<CLI::ConfigItem> SceneFile::from_config(std::istream& input) const {
  std::string text{std::istreambuf_iterator<char>(input), std::istreambuf_iterator<char>()};
  if (std::any_of(text.begin(), text.end(), is_binary)) throw InputError("not a text file");
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // byte order mark

  std::vector<CLI::ConfigItem> keys;
  std::istringstream lines(text);
  std::string line, statement;
  bool in_list = false;
  int number = 0;
  try {
    while (std::getline(lines, line)) {
      ++number;
      append(line, statement, in_list);
      if (in_list || CLI::detail::trim(statement).empty()) continue;
      keys.push_back(item(statement));
      for (auto key = keys.begin(); key + 1 != keys.end(); ++key)
        if (key->name == keys.back().name) throw InputError(key->name + " is given twice");
      statement.clear();
    }
    if (in_list) throw InputError("a list is not closed by ]");
  } catch (const InputError& error) {
    throw InputError("line " + std::to_string(number) + ": " + error.what());
  }
  return keys;
}

std::string SceneFile::to_config(const CLI::App* app, bool, bool, std::string) const {
  std::istringstream lines(CLI::ConfigTOML::to_config(app, true, false, ""));
  std::string config, key, value;
  while (std::getline(lines, key, '=') && std::getline(lines, value)) {
    if (value == R"("")") continue;
    const bool list = app->get_option("--" + key)->get_expected_max() > 1;
    config += key + delimiter + (list && value.front() != '[' ? '[' + value + ']' : value) + '\n';
  }
  return config;
}

std::string without_keys(const std::string& config, const std::vector<std::string>& keys) {
  std::istringstream lines(config);
  std::string kept, line;
  while (std::getline(lines, line)) {
    const std::string key = line.substr(0, line.find(delimiter));
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) kept += line + '\n';
  }
  return kept;
}

}  // namespace flatspeckle::apps

#include "apps/command/scene_file.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

#include "core/error.h"

namespace flatspeckle::apps {

namespace {

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
  const auto& values = read[0].inputs;
  if (values.empty() || std::find(values.begin(), values.end(), "") != values.end() ||
      (values.size() > 1 && statement.find('[') == std::string::npos))
    throw InputError(read[0].name + ": must have one value or a list [a, b] of values");
  return read[0];
}

std::vector<CLI::ConfigItem> SceneFile::from_config(std::istream& input) const {
  std::string text{std::istreambuf_iterator<char>(input), std::istreambuf_iterator<char>()};
  const auto is_binary = [](unsigned char c) { return std::iscntrl(c) && !std::isspace(c); };
  if (std::any_of(text.begin(), text.end(), is_binary)) throw InputError("not a text file");
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // byte order mark

  std::vector<CLI::ConfigItem> read;
  std::set<std::string> names;
  std::istringstream lines(text);
  std::string line, statement;
  bool in_list = false;
  int number = 0;
  try {
    while (++number, std::getline(lines, line)) {
      append(line, statement, in_list);
      if (in_list || CLI::detail::trim(statement).empty()) continue;
      read.push_back(item(std::exchange(statement, "")));
      const std::string& name = read.back().name;
      if (!names.insert(name).second) throw InputError(name + " is given twice");
    }
    if (in_list) throw InputError("the end comes before a list is closed by ]");
  } catch (const InputError& error) {
    throw InputError("line " + std::to_string(number) + ": " + error.what());
  }
  return read;
}

}  // namespace flatspeckle::apps

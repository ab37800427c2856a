#include "apps/command/scene_file.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>
#include <toml++/toml.h>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

InputError error_at(const toml::source_region& source, const std::string& what) {
  return InputError("line " + std::to_string(source.begin.line) + ": " + what);
}

/// Returns a single (not a list) TOML value as text.
std::string text_of(const std::string& key, const toml::node& value) {
  if (const auto* text = value.as_string()) return text->get();
  if (const auto* whole = value.as_integer()) return std::to_string(whole->get());
  if (const auto* number = value.as_floating_point()) return number_text(number->get());
  if (const auto* answer = value.as_boolean()) return answer->get() ? "true" : "false";
  throw error_at(value.source(), key +
                                     ": must be a text, a number, true, false or a list of "
                                     "these; scene files have no [tables]");
}

SceneEntry entry_of(const std::string& key, const toml::node& value) {
  SceneEntry entry{key, {}};
  if (std::isalpha(static_cast<unsigned char>(key[0])) == 0)
    throw error_at(value.source(), key + ": must begin with a letter");
  if (const auto* list = value.as_array())
    for (const toml::node& element : *list) entry.values.push_back(text_of(key, element));
  else
    entry.values = {text_of(key, value)};
  if (entry.values.empty() || std::ranges::find(entry.values, "") != entry.values.end())
    throw error_at(value.source(), key + ": must have one value or a list [a, b] of values");
  return entry;
}

/// Returns an error whose message contains the line that is not valid TOML and the reason.
InputError explain(const std::string& text, const toml::parse_error& error) {
  std::istringstream lines(text);
  std::string line;
  for (auto left = error.source().begin.line; left > 0; --left) std::getline(lines, line);
  const auto is_beyond_ascii = [](unsigned char c) {
    return c > 0x7F;
  };  // such characters may be invalid UTF-8
  std::replace_if(line.begin(), line.end(), is_beyond_ascii, '?');
  const std::string_view why = error.description();  // "Error while parsing value: ..."
  return error_at(error.source(), line + ": " + std::string(why.substr(why.find(": ") + 2)) +
                                      "; expected key = value, texts in quotation marks");
}

}  // namespace

std::vector<SceneEntry> read_scene(const std::string& text) {
  const auto is_binary = [](unsigned char c) { return std::iscntrl(c) && !std::isspace(c); };
  if (std::ranges::any_of(text, is_binary)) throw InputError("not a text file");
  std::vector<SceneEntry> entries;
  try {
    for (const auto& [key, value] : toml::parse(text))
      entries.push_back(entry_of(std::string(key.str()), value));
  } catch (const toml::parse_error& error) {
    throw explain(text, error);
  }
  return entries;
}

}  // namespace flatspeckle::apps

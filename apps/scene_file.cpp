#include "apps/scene_file.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <sstream>

#include "core/error.h"

namespace flatspeckle::apps {

namespace {

constexpr char end_of_text = '\0';
constexpr const char* delimiter = " = ";

bool is_control(char c) {
  return (static_cast<unsigned char>(c) < ' ' && c != '\t' && c != '\n' && c != '\r') ||
         c == '\x7f';
}

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

/// Numbers, true and false; what they mean is for the option to say.
bool is_bare_character(char c) {
  return is_key_character(c) || c == '+' || c == '.';
}

class SceneText {
 public:
  explicit SceneText(std::istream& input)
      : text_(std::istreambuf_iterator<char>(input), std::istreambuf_iterator<char>()) {
    if (std::any_of(text_.begin(), text_.end(), is_control)) throw InputError("not a text file");
  }

  std::vector<CLI::ConfigItem> items() {
    std::vector<CLI::ConfigItem> items;
    for (skip_to_content(); here() != end_of_text; skip_to_content()) {
      CLI::ConfigItem item;
      item.name = key();
      for (const auto& other : items)
        if (other.name == item.name) fail(item.name + " is given twice");
      item.inputs = value(item.name);
      end_line(item.name);
      items.push_back(std::move(item));
    }
    return items;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    const auto lines =
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    throw InputError("line " + std::to_string(lines + 1) + ": " + what);
  }

  char here() const { return at_ < text_.size() ? text_[at_] : end_of_text; }

  bool take(char c) {
    if (here() != c) return false;
    ++at_;
    return true;
  }

  std::string take_while(bool (*belongs)(char)) {
    const std::size_t from = at_;
    while (belongs(here())) ++at_;
    return text_.substr(from, at_ - from);
  }

  void skip_blanks() {
    while (here() == ' ' || here() == '\t' || here() == '\r') ++at_;
    if (here() == '#') at_ = std::min(text_.find('\n', at_), text_.size());
  }

  void skip_to_content() {
    do skip_blanks();
    while (take('\n'));
  }

  std::string key() {
    if (here() == '[') fail("a scene is one flat list of keys, without [tables]");
    const std::string name = take_while(is_key_character);
    skip_blanks();
    if (name.empty() || !take('='))
      fail(name + (name.empty() ? "" : ": ") + "expected key = value");
    skip_blanks();
    return name;
  }

  std::vector<std::string> value(const std::string& name) {
    if (!take('[')) return {scalar(name)};
    std::vector<std::string> list;
    for (skip_to_content(); !take(']'); skip_to_content()) {
      list.push_back(scalar(name));
      skip_to_content();
      if (!take(',') && here() != ']') fail(name + ": expected , or ] in the list");
    }
    if (list.empty()) fail(name + " = []: must hold at least one value");
    return list;
  }

  std::string scalar(const std::string& name) {
    if (here() == '"' || here() == '\'') return quoted(name);
    const std::string word = take_while(is_bare_character);
    if (word.empty()) fail(name + ": expected a number, \"text\", or a list [a, b]");
    return word;
  }

  /// A backslash lets a " or a backslash be part of a "string"; a 'string' is taken as it is.
  std::string quoted(const std::string& name) {
    const char quote = text_[at_++];
    std::string content;
    while (!take(quote)) {
      if (here() == end_of_text || here() == '\n')
        fail(name + ": the text is not closed by " + quote);
      if (quote == '"' && take('\\') && here() != '"' && here() != '\\')
        fail(name + ": a backslash in \"text\" is written \\\\");
      content += text_[at_++];
    }
    return content;
  }

  void end_line(const std::string& name) {
    skip_blanks();
    if (here() != '\n' && here() != end_of_text)
      fail(name + ": one value; text stands in \"\", a list in [ ]");
  }

  std::string text_;
  std::size_t at_ = 0;
};

std::string in_quotes(const std::string& text) {
  std::string quoted;
  for (char c : text) quoted += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
  return '"' + quoted + '"';
}

/// The shortest form that reads back as the same number: 20.0 and 2e1 are 20.
std::string number(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  if (const auto read = std::from_chars(text.data(), end, value);
      read.ec != std::errc{} || read.ptr != end)
    return text;
  char shortest[32];
  return {shortest, std::to_chars(shortest, shortest + sizeof shortest, value).ptr};
}

std::string element(const CLI::Option& option, const std::string& text) {
  const std::string type = option.get_type_name();
  if (type == "TEXT") return in_quotes(text);
  return type == "FLOAT" ? number(text) : text;
}

/// Empty where there is neither value nor default.
std::string value_of(const CLI::Option& option) {
  if (option.get_expected_min() == 0)
    return option.count() > 0 ? option.as<std::string>() : "false";
  if (option.count() == 0) {
    const std::string text = option.get_default_str();
    return text.empty() ? text : element(option, text);
  }
  std::string joined;
  for (const auto& text : option.results())
    joined += (joined.empty() ? "" : ", ") + element(option, text);
  return option.get_expected_max() > 1 ? '[' + joined + ']' : joined;
}

}  // namespace

std::string SceneFile::to_config(const CLI::App* app, bool, bool, std::string) const {
  std::string config;
  for (const CLI::Option* option : app->get_options()) {
    if (!option->get_configurable()) continue;
    const std::string value = value_of(*option);
    if (!value.empty()) config += option->get_single_name() + delimiter + value + '\n';
  }
  return config;
}

std::vector<CLI::ConfigItem> SceneFile::from_config(std::istream& input) const {
  return SceneText(input).items();
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

#include "apps/command/key_lists.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

std::size_t letters_apart(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t before = i;  // of a's letters up to i and b's up to j
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = before + (a[i] == b[j] ? 0 : 1);
      before = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, before + 1});
    }
  }
  return row.back();
}

std::string nearest_key(const Keys& keys, const std::string& name) {
  std::size_t least = std::min<std::size_t>(2, (name.size() + 1) / 3) + 1;
  std::string nearest;
  for (const Key& key : keys.rows()) {
    const std::size_t apart = letters_apart(name, key.name());
    if (apart >= least) continue;
    least = apart;
    nearest = key.name();
  }
  return nearest;
}

const char* type_of(const Key& key) {
  return key.is_switch()   ? "switch"
         : key.is_whole()  ? "integer"
         : key.is_number() ? "number"
                           : "text";
}

/// "NUMBER ..." with the default.
std::string shape_of(const Key& key) {
  if (key.is_switch()) return "";
  std::string shape = key.is_whole() ? " INT" : key.is_number() ? " FLOAT" : " TEXT";
  if (!key.default_value().empty()) shape += '=' + joined(key.default_value(), ",");
  return shape + (key.is_list() ? " ..." : "");
}

std::string quoted_list(const std::vector<std::string>& texts) {
  std::vector<std::string> all;
  for (const std::string& text : texts) all.push_back(quoted(text));
  return '[' + joined(all, ", ") + ']';
}

const char* json(bool value) {
  return value ? "true" : "false";
}

/// One object for each row.
void print_json(const Keys& keys) {
  const char* between = "\n";
  std::cout << '[';
  for (const Key& key : keys.rows()) {
    std::cout << between << "  {\"name\": " << quoted(key.name())
              << ", \"group\": " << quoted(key.group()) << ", \"type\": " << quoted(type_of(key))
              << ", \"list\": " << json(key.is_list()) << ", \"file\": " << json(key.is_file())
              << ", \"in_scene_files\": " << json(key.is_in_files())
              << ", \"effort\": " << json(key.is_effort())
              << ", \"default\": " << quoted_list(key.default_value())
              << ", \"words\": " << quoted_list(key.words()) << ", \"unit\": " << quoted(key.unit())
              << ", \"only_of\": " << quoted(key.only_of())
              << ", \"accepted\": " << quoted(key.accepted())
              << ", \"help\": " << quoted(key.help()) << '}';
    between = ",\n";
  }
  std::cout << "\n]";
}

/// Groups whole, in the order in which they come first.
std::vector<const Key*> in_groups(const Keys& keys) {
  std::map<std::string, std::size_t> first;
  std::vector<const Key*> rows;
  for (const Key& key : keys.rows()) {
    first.emplace(key.group(), first.size());
    rows.push_back(&key);
  }
  std::stable_sort(rows.begin(), rows.end(), [&](const Key* a, const Key* b) {
    return first[a->group()] < first[b->group()];
  });
  return rows;
}

void print_markdown(const Keys& keys, const std::string& subcommand) {
  std::cout << "\n## " << subcommand << '\n';
  std::string group;
  for (const Key* row : in_groups(keys)) {
    const Key& key = *row;
    if (key.group() != group)
      std::cout << "\n**" << key.group() << "**\n\n| key | default | meaning |\n|---|---|---|\n";
    group = key.group();
    std::string meaning;
    for (const char c : key.help()) meaning += c == '|' ? std::string("\\|") : std::string(1, c);
    std::cout << "| `" << key.name() << "` | " << joined(key.default_value(), " ") << " | "
              << meaning << " |\n";
  }
}

void print_man(const Keys& keys) {
  std::string group;
  for (const Key* row : in_groups(keys)) {
    if (row->group() != group) std::cout << ".SS " << roff(row->group()) << '\n';
    group = row->group();
    std::cout << ".TP\n\\fB" << roff("--" + row->name()) << "\\fR" << roff(shape_of(*row)) << '\n'
              << roff(row->help()) << '\n';
  }
}

void print_completion(const Keys& keys, const std::string& subcommand) {
  std::set<std::string> flags{"--config", "--help", "--print-config"};
  for (const Key& key : keys.rows()) flags.insert("--" + key.name());
  std::cout << "    " << subcommand << ") flags=\"";
  for (const std::string& flag : flags) std::cout << flag << ' ';
  std::cout << "\" ;;\n";
}

void print_dictionary(const Keys& keys) {
  for (const Key& key : keys.rows()) {
    std::cout << quoted(key.name()) << '\n';
    for (const std::string& word : key.words()) std::cout << quoted(word) << '\n';
  }
}

}  // namespace

std::string did_you_mean(const Keys& keys, const std::string& name) {
  const std::string nearest = nearest_key(keys, name);
  return nearest.empty() ? "" : "; did you mean " + nearest + '?';
}

std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') all += '\\';
    all += c;
  }
  return all + '"';
}

std::string roff(const std::string& text) {
  std::string all = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) {
    if (c == '-') all += '\\';
    all += c;
    if (c == '\\') all += 'e';
  }
  return all;
}

void print_help_lines(const Keys& keys) {
  std::string group;
  for (const Key* row : in_groups(keys)) {
    const Key& key = *row;
    if (key.group() != group)
      std::printf("%s%s:\n", group.empty() ? "" : "\n", key.group().c_str());
    group = key.group();
    std::printf("  %-31s %s\n", ("--" + key.name() + shape_of(key)).c_str(), key.help().c_str());
  }
}

void print_keys(const Keys& keys, const std::string& subcommand, const std::string& form) {
  if (form == "json") print_json(keys);
  if (form == "markdown") print_markdown(keys, subcommand);
  if (form == "man") print_man(keys);
  if (form == "completion" || form == "zsh") print_completion(keys, subcommand);
  if (form == "dictionary") print_dictionary(keys);
}

}  // namespace flatspeckle::apps

#include "apps/command/key_lists.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/version.h"

namespace flatspeckle::apps {

std::unique_ptr<Call> list_keys(const std::string& of);

namespace {

/// Quotes a text for JSON.
std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') all += '\\';
    all += c;
  }
  return all + '"';
}

/// Escapes a text for manual pages (roff).
std::string roff(const std::string& text) {
  std::string all = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) {
    if (c == '-') all += '\\';
    all += c;
    if (c == '\\') all += 'e';
  }
  return all;
}

std::size_t letters_apart(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    // Levenshtein distance of the first i letters of a from the first j letters of b.
    std::size_t before = i;
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

/// Returns the text that stands for the value of a key in its line of --help, with the default: "
/// FLOAT=1 ...".
std::string shape_of(const Key& key) {
  if (key.is_switch()) return "";
  std::string shape = key.is_whole() ? " INT" : key.is_number() ? " FLOAT" : " TEXT";
  if (!key.default_value().empty()) shape += '=' + join_texts(key.default_value(), ",");
  return shape + (key.is_list() ? " ..." : "");
}

std::string quoted_list(const std::vector<std::string>& texts) {
  std::vector<std::string> all;
  for (const std::string& text : texts) all.push_back(quoted(text));
  return '[' + join_texts(all, ", ") + ']';
}

const char* json(bool value) {
  return value ? "true" : "false";
}

/// Prints the key definitions as a JSON list of objects.
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

/// Returns the key definitions sorted by their groups. Groups are in the order of their first keys.
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
    std::cout << "| `" << key.name() << "` | " << join_texts(key.default_value(), " ") << " | "
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

/// Prints the keys of a subcommand in the format `form`.
void print_keys(const Keys& keys, const std::string& subcommand, const std::string& form) {
  if (form == "json") print_json(keys);
  if (form == "markdown") print_markdown(keys, subcommand);
  if (form == "man") print_man(keys);
  if (form == "completion" || form == "zsh") print_completion(keys, subcommand);
  if (form == "dictionary") print_dictionary(keys);
}

/// Texts of an output format: before, between and after the keys of the subcommands.
struct Frame {
  const char *form, *before, *between, *after;
};

constexpr Frame frame_of_form[] = {
    {"json", "\"subcommands\": {\n", "},\n", "}\n}}\n"},
    {"markdown", "", "", ""},
    {"man",
     ".TH FLATSPECKLE 1\n.SH NAME\nflatspeckle \\- speckle statistics: path-space Monte Carlo "
     "checked "
     "by an exact wave solver\n.SH SYNOPSIS\n\\fBflatspeckle\\fR SUBCOMMAND [\\-\\-config "
     "SCENE.toml] "
     "[\\-\\-key value ...] \\-\\-out FILE.h5\n",
     "",
     ".SH EXIT STATUS\n0 done, 2 bad input, 3 stopped before the target error was reached, 4 input "
     "or "
     "output failed, 5 a row of a benchmark failed, 75 interrupted and resumable, 130 interrupted, "
     "nothing to resume.\n"},
    {"dictionary", "", "", ""},
    {"completion",
     "# Completion for bash: source <(flatspeckle keys completion)\n"
     "_flatspeckle() {\n  local flags=",
     "",
     "  esac\n"
     "  COMPREPLY=($(compgen -f -W \"$flags\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n"
     "}\n"
     "complete -F _flatspeckle flatspeckle\n"},
    {"zsh", "#compdef flatspeckle\nlocal flags=", "", "  esac\ncompadd -- ${=flags}\n_files\n"}};

const Frame& frame_named(const std::string& form) {
  for (const Frame& frame : frame_of_form)
    if (form == frame.form) return frame;
  throw InputError("keys", form, "must be one of json markdown man dictionary completion zsh");
}

void print_owners() {
  std::cout << "\n## Which key belongs to which subcommand\n\n| key | subcommands |\n|---|---|\n";
  for (const auto& [key, owners] : key_owners())
    std::cout << "| `" << key << "` | " << join_texts(owners, ", ") << " |\n";
}

/// For shell completion, prints the names of the subcommands, which are completed as the first
/// word, and the beginning of the `case` statement that selects the flags of a subcommand.
void print_first_words(const std::string& shell) {
  std::cout << '"';
  for (const SubcommandEntry& entry : subcommands()) std::cout << entry.name << ' ';
  std::cout << (shell == "zsh" ? "\"\n  (( CURRENT == 2 )) || case \"${words[2]}\" in\n"
                               : "\"\n  [[ $COMP_CWORD == 1 ]] || case \"${COMP_WORDS[1]}\" in\n");
}

void print_heading(const std::string& form, const SubcommandEntry& entry) {
  if (form == "json")
    std::cout << quoted(entry.name) << ": {\"purpose\": " << quoted(entry.purpose)
              << ", \"keys\": ";
  if (form == "man")
    std::cout << ".SH flatspeckle " << roff(entry.name) << '\n' << roff(entry.purpose) << '\n';
}

/// Prints the keys of all subcommands in the format that the user has named. JSON also contains the
/// version and the purpose of each subcommand.
int print_all_keys(const Subcommand&, Words& values) {
  const std::string form = values.words.empty() ? "json" : values.text();
  const Frame& frame = frame_named(form);
  if (form == "json")
    std::cout << "{\"version\": " << quoted(version()) << ", \"commit\": " << quoted(git_commit())
              << ",\n ";
  std::cout << frame.before;
  if (form == "completion" || form == "zsh") print_first_words(form);
  if (form == "markdown") print_owners();
  const char* between = "";
  for (const SubcommandEntry& entry : subcommands()) {
    if (entry.make == list_keys) continue;
    std::cout << between;
    print_heading(form, entry);
    print_keys(make_call(entry)->command().all_keys(), entry.name, form);
    between = frame.between;
  }
  std::cout << frame.after;
  return ExitStatus::done;
}

}  // namespace

std::string did_you_mean(const Keys& keys, const std::string& name) {
  const std::string nearest = nearest_key(keys, name);
  return nearest.empty() ? "" : "; did you mean " + nearest + '?';
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

std::unique_ptr<Call> list_keys(const std::string&) {
  return call_with<Words>("keys",
                          "Lists the keys of all subcommands: keys FORMAT, one of json markdown "
                          "man dictionary completion zsh (default: json)",
                          print_all_keys);
}

}  // namespace flatspeckle::apps

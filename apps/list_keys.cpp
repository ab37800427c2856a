#include <algorithm>
#include <cstring>
#include <iostream>

#include "apps/command/key_lists.h"
#include "apps/command/key_owners.h"
#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/version.h"

namespace flatspeckle::apps {

namespace {

/// What stands before, between and after the keys of the subcommands.
struct Frame {
  const char *form, *before, *between, *after;
};

constexpr Frame frames[] = {
    {"json", "\"subcommands\": {\n", "},\n", "}\n}}\n"},
    {"markdown", "", "", ""},
    {"dictionary", "", "", ""},
    {"completion",
     "# Completion for bash: source <(flatspeckle keys completion)\n"
     "_flatspeckle() {\n  local words\n  case \"${COMP_WORDS[1]}\" in\n",
     "",
     "  esac\n"
     "  COMPREPLY=($(compgen -f -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n"
     "}\n"
     "complete -F _flatspeckle flatspeckle\n"}};

const Frame& frame_named(const std::string& form) {
  for (const Frame& frame : frames)
    if (form == frame.form) return frame;
  throw InputError("keys", form, "must be one of json markdown dictionary completion");
}

void print_owners() {
  std::cout << "\n## Which key belongs to which subcommand\n\n| key | of |\n|---|---|\n";
  for (const auto& [key, owners] : key_owners())
    std::cout << "| `" << key << "` | " << joined(owners, ", ") << " |\n";
}

}  // namespace

/// Each subcommand prints its own. JSON begins with the version, and each subcommand's purpose.
int list_keys(const Arguments& arguments) {
  const std::string form = arguments.size() > 2 ? arguments[2] : "json";
  const Frame& frame = frame_named(form);
  const bool is_json = form == "json";
  if (is_json)
    std::cout << "{\"version\": " << quoted(version()) << ", \"commit\": " << quoted(git_commit())
              << ",\n ";
  std::cout << frame.before;
  if (form == "markdown") print_owners();
  const char* between = "";
  for (const SubcommandEntry& entry : subcommands()) {
    if (entry.run == list_keys) continue;
    std::cout << between;
    if (is_json)
      std::cout << quoted(entry.name) << ": {\"purpose\": " << quoted(entry.purpose)
                << ", \"keys\": ";
    entry.run({"flatspeckle", entry.name, "--keys=" + form});
    between = frame.between;
  }
  std::cout << frame.after;
  return ExitStatus::done;
}

}  // namespace flatspeckle::apps

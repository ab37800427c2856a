#include <iostream>

#include "apps/command/key_lists.h"
#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/version.h"

namespace flatspeckle::apps {

std::unique_ptr<Call> list_keys(const std::string& of);

namespace {

/// What stands before, between and after the keys of the subcommands.
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
  std::cout << "\n## Which key belongs to which subcommand\n\n| key | of |\n|---|---|\n";
  for (const auto& [key, owners] : key_owners())
    std::cout << "| `" << key << "` | " << joined(owners, ", ") << " |\n";
}

/// Of completion: what the first word may be; the others are flags of it.
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

/// JSON begins with the version, and each subcommand's purpose.
int print_all_keys(const Subcommand&, OneWord& values) {
  const std::string form = values.word.empty() ? "json" : values.word;
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

std::unique_ptr<Call> list_keys(const std::string&) {
  return call_with<OneWord>("keys", "The keys of all subcommands: keys FORM, json if not given",
                            print_all_keys);
}

}  // namespace flatspeckle::apps

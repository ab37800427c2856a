#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "apps/command/command_line.h"
#include "core/keys/number_text.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

class Experiment;

/// One call of a subcommand: its keys with their values, and the work done with them.
class Call {
 public:
  virtual ~Call() = default;
  virtual Subcommand& command() = 0;
  /// Does the work, after the values of the keys are set. Returns the exit status.
  virtual int run() = 0;
};

/// Call whose values are the members of a struct. The keys that set the members are added by the
/// function add_keys(keys, values) in the namespace of the struct. If the struct has a member
/// `words`, it receives the words before the flags, such as FILE in `explain FILE`.
template <typename Values>
class CallWith : public Call {
 public:
  using Run = int (*)(const Subcommand&, Values&);

  CallWith(const char* name, const std::string& title, Run work)
      : command_(name, title), work_(work) {
    add_keys(command_.keys(), values_);
    if constexpr (requires { values_.words; }) command_.take_words(values_.words);
  }
  Subcommand& command() override { return command_; }
  int run() override { return work_(command_, values_); }

 private:
  Subcommand command_;
  Values values_;
  Run work_;
};

template <typename Values>
std::unique_ptr<Call> call_with(const char* name, const std::string& title,
                                typename CallWith<Values>::Run run) {
  return std::make_unique<CallWith<Values>>(name, title, run);
}

struct NoKeys {
  friend void add_keys(Keys&, NoKeys&) {}
};
struct Words : NoKeys {
  std::vector<std::string> words;

  /// Returns all words with blanks between them, for subcommands that accept one word.
  std::string text() const { return join_texts(words, " "); }
};

/// A subcommand of the program. It is defined either by `make`, which makes its call, or by
/// `experiment`, if it makes one result and can also be run by sweeps and searches.
struct SubcommandEntry {
  const char *name, *purpose;
  /// Makes the call; nullptr if `experiment` is given. of: for sweep and optimise, the subcommand
  /// whose keys are included; if empty, the call has only its own keys.
  std::unique_ptr<Call> (*make)(const std::string& of);
  const char* title = nullptr;  ///< heading of --help, if `experiment` is given
  std::unique_ptr<Experiment> (*experiment)() = nullptr;
  /// Default of the key `of`; nullptr if the subcommand has no key `of`.
  const char* of = nullptr;
};

/// Returns all subcommands, in the order of --help. To add one, declare and list it in
/// subcommands.cpp.
std::span<const SubcommandEntry> subcommands();

/// Makes a call of a subcommand, with all keys at their defaults.
std::unique_ptr<Call> make_call(const SubcommandEntry& entry, const std::string& of = "");
/// Outcome of a call: the exit status, and whether the call has written a result file besides
/// printing.
struct CallEnd {
  int status = ExitStatus::done;
  bool has_result = false;
};
/// Parses the arguments and runs the subcommand.
CallEnd run_subcommand(const SubcommandEntry& entry, const Arguments& arguments);

/// Returns, for each key name, the subcommands that have the key, in the order of the help.
std::map<std::string, std::vector<std::string>> key_owners();

}  // namespace flatspeckle::apps

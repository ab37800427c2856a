#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "apps/command/command_line.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

class Experiment;

/// One call of a subcommand: its keys, bound to values of its own, and what is done with them.
class Call {
 public:
  virtual ~Call() = default;
  virtual Subcommand& command() = 0;
  /// Once the keys are filled. Returns the exit status.
  virtual int run() = 0;
};

/// With a struct of values; add_keys(keys, values) is found by the struct's name. A member `word`
/// is what stands before the flags, as in `explain FILE`.
template <typename Values>
class CallWith : public Call {
 public:
  using Run = int (*)(const Subcommand&, Values&);

  CallWith(const char* name, const std::string& title, Run work)
      : command_(name, title), work_(work) {
    add_keys(command_.keys(), values_);
    if constexpr (requires { values_.word; }) command_.take_word(values_.word);
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
struct OneWord : NoKeys {
  std::string word;
};

/// A subcommand of the program: a call of its own, or an experiment, which makes one result
/// and which sweeps and searches run too.
struct SubcommandEntry {
  const char *name, *purpose;
  /// of: the subcommand whose keys it has too, empty where its own keys alone are wanted.
  std::unique_ptr<Call> (*make)(const std::string& of);
  const char* title = nullptr;  ///< of an experiment: the head of --help
  std::unique_ptr<Experiment> (*experiment)() = nullptr;
  /// The subcommand meant where the key `of` is not given; nullptr where there is no such key.
  const char* of = nullptr;
};

/// All of them, in the order of the help. A new subcommand is declared and listed in
/// subcommands.cpp.
std::span<const SubcommandEntry> subcommands();

/// A call whose keys are at their defaults.
std::unique_ptr<Call> make_call(const SubcommandEntry& entry, const std::string& of = "");
/// How a call ended: the exit status, and whether it makes a result, apart from what it prints.
struct CallEnd {
  int status = ExitStatus::done;
  bool has_result = false;
};
/// Parses the arguments and runs.
CallEnd run_subcommand(const SubcommandEntry& entry, const Arguments& arguments);

/// Which subcommands have a key, by its name, in the order of the help.
std::map<std::string, std::vector<std::string>> key_owners();

}  // namespace flatspeckle::apps

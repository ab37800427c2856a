#pragma once

#include <span>

#include "apps/command/command_line.h"
#include "core/session/exit_status.h"

namespace flatspeckle::apps {

/// What the program can be asked for. It parses its own arguments, runs, and writes its result
/// file.
struct SubcommandEntry {
  const char *name, *purpose;
  int (*run)(const Arguments&);
};

/// All of them, in the order of the help. A new subcommand is declared and listed in
/// subcommands.cpp.
std::span<const SubcommandEntry> subcommands();

}  // namespace flatspeckle::apps

#pragma once

#include <string>
#include <vector>

#include "core/keys/keys.h"

namespace flatspeckle::apps {

// Keys as texts for people and programs, all by their rows.

/// A text of JSON.
std::string quoted(const std::string& text);
/// A text of manual pages.
std::string roff(const std::string& text);

/// The lines of --help, by groups.
void print_help_lines(const Keys& keys);

/// Prints the keys of a subcommand where its only argument asks for that: --keys=json, =markdown,
/// =man, =completion, =dictionary (of fuzzers) or =names. False where it does not.
bool print_keys(const Keys& keys, const std::string& subcommand,
                const std::vector<std::string>& arguments);

}  // namespace flatspeckle::apps

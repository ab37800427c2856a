#pragma once

#include <string>

#include "core/keys/keys.h"

namespace flatspeckle::apps {

/// Returns a text such as "; did you mean depth?" for a misspelt key name. It names the key with
/// the fewest inserted, deleted or changed letters (Levenshtein 1966): at most two, or one for
/// short names. Empty if there is no such key.
std::string did_you_mean(const Keys& keys, const std::string& name);

// Printing of the keys of a subcommand.

/// Prints the lines of --help about the keys, sorted by their groups.
void print_help_lines(const Keys& keys);

}  // namespace flatspeckle::apps

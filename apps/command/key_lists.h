#pragma once

#include <string>

#include "core/keys/keys.h"

namespace flatspeckle::apps {

/// "; did you mean depth?", of the key that a misspelt name was likely meant to be: of the fewest
/// letters to add, take out or change, at most two, one of short names (Levenshtein 1966). Empty
/// where there is none.
std::string did_you_mean(const Keys& keys, const std::string& name);

// Keys as texts for people and programs, all by their rows.

/// The lines of --help, by groups.
void print_help_lines(const Keys& keys);

}  // namespace flatspeckle::apps

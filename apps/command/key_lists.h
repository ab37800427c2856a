#pragma once

#include <string>

#include "core/keys/keys.h"

namespace flatspeckle::apps {

/// "; did you mean depth?", of the key that a misspelt name was likely meant to be: of the fewest
/// letters to add, take out or change, at most two, one of short names (Levenshtein 1966). Empty
/// where there is none.
std::string did_you_mean(const Keys& keys, const std::string& name);

// Keys as texts for people and programs, all by their rows.

/// A text of JSON.
std::string quoted(const std::string& text);
/// A text of manual pages.
std::string roff(const std::string& text);

/// The lines of --help, by groups.
void print_help_lines(const Keys& keys);

/// The keys of a subcommand as json, markdown, man, completion (of bash), zsh or dictionary (of
/// fuzzers).
void print_keys(const Keys& keys, const std::string& subcommand, const std::string& form);

}  // namespace flatspeckle::apps

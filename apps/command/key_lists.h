#pragma once

#include <string>

#include "core/keys/keys.h"

namespace flatspeckle::apps {

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

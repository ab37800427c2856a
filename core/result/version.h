#pragma once

#include <string>

namespace flatspeckle {

/// Returns the version of the program, e.g. "0.1.0".
std::string version();

/// Returns the git commit from which the program was built, with "+changes" if tracked files had
/// been changed; "unknown" if the program was built outside a git checkout.
std::string git_commit();

}  // namespace flatspeckle

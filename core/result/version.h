#pragma once

#include <string>

namespace flatspeckle {

/// "0.1.0".
std::string version();

/// Commit of the checkout that was built, with "+changes" where tracked files differed from it;
/// "unknown" when built outside a checkout.
std::string git_commit();

}  // namespace flatspeckle

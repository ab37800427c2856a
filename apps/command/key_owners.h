#pragma once

#include <map>
#include <string>
#include <vector>

namespace flatspeckle::apps {

/// Which subcommands have a key, by its name, in the order of the help.
std::map<std::string, std::vector<std::string>> key_owners();

}  // namespace flatspeckle::apps

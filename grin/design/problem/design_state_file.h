#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "grin/design/problem/designer.h"

namespace flatspeckle::grin::design {

/// Where a search that was cut off goes on from: beside its result, NAME.state.
std::filesystem::path state_path(const std::filesystem::path& out);

/// identity: what tells one search from another. Throws IoError.
void save_state(const std::filesystem::path& path, const std::string& identity,
                const DesignState& state);

/// Whether it is there and whole, and of this search.
bool holds(const std::filesystem::path& path, const std::string& identity);

/// Nothing where there is no such file. Throws InputError for one that is damaged, or of another
/// search.
std::optional<DesignState> read_state(const std::filesystem::path& path,
                                      const std::string& identity);

}  // namespace flatspeckle::grin::design

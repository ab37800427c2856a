#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flatspeckle::grin {

/// A key of `render` and its values, as on the command line.
struct McxKey {
  std::string key;
  std::vector<std::string> values;
};

/// Translates an MCX scene [fang2009] into keys of `render`. Lengths are in mm. The light that the
/// volume reflects at its faces, if DoMismatch is set, is that of a body in a stage that is larger
/// by a thin gap. Throws InputError for a member without counterpart, which is named.
std::vector<McxKey> mcx_keys(const std::filesystem::path& path);

}  // namespace flatspeckle::grin

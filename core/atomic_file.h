#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace flatspeckle {

/// Makes sure, before long work, that a file can be put at `path`; leaves nothing behind. Throws
/// InputError where the folder is missing or closed to us, or something that is no file is there.
void check_writable(const std::filesystem::path& path);

/// Puts `bytes` at `path` as a whole or not at all, also when the machine stops in between: written
/// beside it under a temporary name (.name.tmp-PID), synced, renamed. Throws IoError, having
/// removed the temporary file and left what was at `path` before.
void replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace flatspeckle

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

namespace flatspeckle {

/// Returns the bytes behind their length and checksum: a block of a BlockFile.
std::vector<std::byte> block_of(std::span<const std::byte> bytes);

/// A file of blocks of bytes that only grows, each with its length and checksum: what was written
/// before a process died is there, and what was being written is known not to be.
class BlockFile {
 public:
  enum class Access { read, append };
  /// Made where it is not there, to append. Throws IoError.
  BlockFile(std::filesystem::path path, Access access);
  BlockFile(const BlockFile&) = delete;
  BlockFile& operator=(const BlockFile&) = delete;
  ~BlockFile();

  const std::filesystem::path& path() const { return path_; }

  /// What follows the last whole block: nothing, the beginning of one, or something else.
  enum class Tail { none, torn, damaged };
  /// use(place, bytes) of each whole block, in order, up to the first that is not.
  Tail scan(const std::function<void(std::uint64_t place, std::span<const std::byte>)>& use);
  /// Takes off what follows the blocks that scan() has found.
  void cut();

  /// Adds a block, and returns its place. Throws IoError, having left the file as it was.
  std::uint64_t append(std::span<const std::byte> bytes);
  /// The block there. Throws IoError where it is no longer whole.
  std::vector<std::byte> read(std::uint64_t place) const;
  /// Waits until the disk has it all.
  void sync() const;

 private:
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t end_ = 0;  ///< of the whole blocks
};

}  // namespace flatspeckle

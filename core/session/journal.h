#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/byte_stream.h"
#include "core/result/atomic_file.h"

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

/// The first record of a journal: what the others belong to.
struct JournalHead {
  std::string identity;     ///< equal texts, equal numbers
  std::string config = {};  ///< a scene file that makes the same again, where there is one
};

/// Records of work that is done, in a file that only grows (BlockFile): what was written before a
/// process died is there. A letter says the kind of each record. Sweeps, searches and runs that
/// can go on keep what they have in such files.
class Journal {
 public:
  /// Called with each record of this identity that is found: its place, kind and contents.
  using Use = std::function<void(std::uint64_t place, char kind, ByteReader&)>;

  /// Goes on with the file there, or begins one. What is torn or damaged at its end is cut off,
  /// with a warning and a copy kept where it is damaged. whose: "sweep", for messages. Throws
  /// InputError where the records there belong to another, IoError.
  Journal(const std::filesystem::path& path, const JournalHead& head, const std::string& whose,
          const Use& use);
  /// Reads alone. Throws InputError where there are no records of this identity, IoError.
  Journal(const std::filesystem::path& path, const std::string& identity, const std::string& whose,
          const Use& use);
  /// Every configuration that the records were made with, the last one last.
  static std::vector<std::string> configs_in(const std::filesystem::path& path);

  bool is_damaged() const { return tail_ == BlockFile::Tail::damaged; }

  /// Adds a record, and returns its place. Throws IoError, having left the file as it was.
  std::uint64_t append(char kind, std::span<const std::byte> record);
  /// The record there. Throws IoError where it is no longer whole.
  std::vector<std::byte> read(std::uint64_t place) const;
  void sync() const { file_.sync(); }

 private:
  void scan(const std::string& identity, const Use& use);
  std::string stranger(const std::string& identity, const std::string& whose) const;
  void keep_damaged() const;

  BlockFile file_;
  std::optional<JournalHead> head_;
  BlockFile::Tail tail_ = BlockFile::Tail::none;
  std::size_t records_ = 0;
};

/// A journal of one record, which replaces the one before as a whole: where a run that was cut off
/// goes on. Throws IoError.
void keep_record(const std::filesystem::path& path, const std::string& identity,
                 std::span<const std::byte> record, Durable durable);
/// Its record; nothing where there is no file. Throws InputError for one that is damaged or belongs
/// to another.
std::optional<std::vector<std::byte>> kept_record(const std::filesystem::path& path,
                                                  const std::string& identity,
                                                  const std::string& whose);

}  // namespace flatspeckle

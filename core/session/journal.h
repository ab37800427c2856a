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

/// Returns the block of a BlockFile that contains these bytes, that is, the bytes preceded by their
/// length and checksum.
std::vector<std::byte> block_of(std::span<const std::byte> bytes);

/// File to which blocks of bytes are appended, each with its length and checksum. If the process
/// dies, blocks that were already written remain readable, and an incomplete block at the end is
/// recognised.
class BlockFile {
 public:
  enum class Access { read, append };
  /// Opens the file. A missing file is created if it is opened to append. Throws IoError.
  BlockFile(std::filesystem::path path, Access access);
  BlockFile(const BlockFile&) = delete;
  BlockFile& operator=(const BlockFile&) = delete;
  ~BlockFile();

  const std::filesystem::path& path() const { return path_; }

  /// Content of the file after its last complete block: nothing, the beginning of a block (torn),
  /// or other bytes (damaged).
  enum class Tail { none, torn, damaged };
  /// Calls use(position in the file, bytes) for each block, in order, up to the first incomplete or
  /// damaged block. Returns what follows the last complete block.
  Tail scan(const std::function<void(std::uint64_t place, std::span<const std::byte>)>& use);
  /// Removes everything after the complete blocks that scan() has found from the file.
  void cut();

  /// Appends a block and returns its position in the file. If this fails, throws IoError and leaves
  /// the file unchanged.
  std::uint64_t append(std::span<const std::byte> bytes);
  /// Returns the bytes of the block at this position. Throws IoError if the block is damaged.
  std::vector<std::byte> read(std::uint64_t place) const;
  /// Waits until all data is on the disk.
  void sync() const;

 private:
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t end_ = 0;  ///< position of the end of the last complete block
};

/// First record of a journal. It identifies the work, such as a sweep, whose results the following
/// records contain.
struct JournalHead {
  std::string identity;     ///< text of all inputs: works with equal texts have equal results
  std::string config = {};  ///< scene file that reproduces the work; empty if there is none
};

/// File of records of finished work (a BlockFile), from which sweeps, searches and runs are resumed
/// after the process has died. Each record has a kind, given by a letter.
class Journal {
 public:
  /// Function that is called with the position, kind and contents of each existing record of this
  /// identity.
  using Use = std::function<void(std::uint64_t place, char kind, ByteReader&)>;

  /// Opens the file at `path` to append records, or creates it. If the end of the file is
  /// incomplete, it is cut off; if it is damaged, a warning is printed and the file is backed up
  /// before. whose: kind of work, for messages, such as "sweep". Throws IoError, and InputError if
  /// the file belongs to another identity.
  Journal(const std::filesystem::path& path, const JournalHead& head, const std::string& whose,
          const Use& use);
  /// Opens an existing file for reading. Throws IoError, and InputError if the file has no records
  /// of this identity.
  Journal(const std::filesystem::path& path, const std::string& identity, const std::string& whose,
          const Use& use);
  /// Returns the scene files (JournalHead::config) of all works whose records are in the file, in
  /// the order of the file.
  static std::vector<std::string> configs_in(const std::filesystem::path& path);

  bool is_damaged() const { return tail_ == BlockFile::Tail::damaged; }

  /// Appends a record and returns its position in the file. If this fails, throws IoError and
  /// leaves the file unchanged.
  std::uint64_t append(char kind, std::span<const std::byte> record);
  /// Returns the record at this position. Throws IoError if the record is damaged.
  std::vector<std::byte> read(std::uint64_t place) const;
  void sync() const { file_.sync(); }

 private:
  void scan(const std::string& identity, const Use& use);
  std::string belongs_to_another(const std::string& identity, const std::string& whose) const;
  void keep_damaged() const;

  BlockFile file_;
  std::optional<JournalHead> head_;
  BlockFile::Tail tail_ = BlockFile::Tail::none;
  std::size_t records_ = 0;
};

/// Writes a journal that contains only this record, the state of an interrupted run. It replaces an
/// existing journal at `path`. Throws IoError.
void keep_record(const std::filesystem::path& path, const std::string& identity,
                 std::span<const std::byte> record, Durable durable);
/// Returns the record of a journal that keep_record() has written; nullopt if the file does not
/// exist. Throws InputError if the journal is damaged or belongs to another identity.
std::optional<std::vector<std::byte>> kept_record(const std::filesystem::path& path,
                                                  const std::string& identity,
                                                  const std::string& whose);

}  // namespace flatspeckle

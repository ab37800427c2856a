#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result/atomic_file.h"
#include "core/result/block_file.h"
#include "core/result/byte_stream.h"

namespace flatspeckle {

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

#include "core/session/journal.h"

#include <iostream>

#include "core/error.h"
#include "core/session/aside.h"
#include "core/session/identity.h"

namespace flatspeckle {

namespace fs = std::filesystem;

namespace {

constexpr char head_kind = 'h', kept_kind = 's';

std::vector<std::byte> with_kind(char kind, std::span<const std::byte> record) {
  std::vector<std::byte> block{std::byte(kind)};
  block.insert(block.end(), record.begin(), record.end());
  return block;
}

std::vector<std::byte> bytes_of(const JournalHead& head) {
  ByteWriter bytes;
  bytes.put(head.identity);
  bytes.put(head.config);
  return bytes.take();
}

JournalHead head_in(ByteReader& bytes) {
  JournalHead head;
  bytes.get(head.identity);
  bytes.get(head.config);
  return head;
}

}  // namespace

Journal::Journal(const fs::path& path, const JournalHead& head, const std::string& whose,
                 const Use& use)
    : file_(path, BlockFile::Access::append) {
  scan(head.identity, use);
  if (head_ && head_->identity != head.identity)
    throw InputError("resume: what " + path.string() + " holds " + stranger(head.identity, whose) +
                     "; name another result file, or remove it");
  if (is_damaged()) keep_damaged();
  file_.cut();
  if (!head_ || head_->config != head.config) append(head_kind, bytes_of(head));
  head_ = head;
}

Journal::Journal(const fs::path& path, const std::string& identity, const std::string& whose,
                 const Use& use)
    : file_(path, BlockFile::Access::read) {
  scan(identity, use);
  if (!head_) throw InputError(path.string() + " is damaged, or of another version");
  if (head_->identity != identity)
    throw InputError(path.string() + ' ' + stranger(identity, whose));
}

std::vector<std::string> Journal::configs_in(const fs::path& path) {
  std::vector<std::string> configs;
  BlockFile(path, BlockFile::Access::read)
      .scan([&](std::uint64_t, std::span<const std::byte> block) {
        ByteReader bytes(block);
        if (bytes.get<char>() == head_kind) configs.push_back(head_in(bytes).config);
      });
  return configs;
}

/// Records of another, which a head before them tells, are passed over.
void Journal::scan(const std::string& identity, const Use& use) {
  tail_ = file_.scan([&](std::uint64_t place, std::span<const std::byte> block) {
    ByteReader bytes(block);
    const char kind = bytes.get<char>();
    if (kind == head_kind) {
      head_ = head_in(bytes);
    } else if (head_ && head_->identity == identity) {
      use(place, kind, bytes);
      ++records_;
    }
  });
}

std::string Journal::stranger(const std::string& identity, const std::string& whose) const {
  return "belongs to another " + whose + " (" + first_difference(head_->identity, identity) + ')';
}

void Journal::keep_damaged() const {
  const fs::path& path = file_.path();
  const auto place = free_aside(path);
  std::error_code failed;
  fs::copy_file(path, place, failed);
  std::cerr << "warning: " + path.string() + " is damaged after " + std::to_string(records_) +
                   " records; " +
                   (failed ? "the rest is done again\n"
                           : "it is kept as " + place.filename().string() +
                                 ", and the rest is done again\n");
}

std::uint64_t Journal::append(char kind, std::span<const std::byte> record) {
  return file_.append(with_kind(kind, record));
}

std::vector<std::byte> Journal::read(std::uint64_t place) const {
  auto block = file_.read(place);
  block.erase(block.begin());
  return block;
}

void keep_record(const fs::path& path, const std::string& identity,
                 std::span<const std::byte> record, Durable durable) {
  auto bytes = block_of(with_kind(head_kind, bytes_of(JournalHead{identity})));
  const auto kept = block_of(with_kind(kept_kind, record));
  bytes.insert(bytes.end(), kept.begin(), kept.end());
  replace_file(path, bytes, durable);
}

std::optional<std::vector<std::byte>> kept_record(const fs::path& path, const std::string& identity,
                                                  const std::string& whose) try {
  if (!fs::exists(path)) return std::nullopt;
  std::optional<std::vector<std::byte>> kept;
  const Journal journal(path, identity, whose, [&](std::uint64_t, char, const ByteReader& record) {
    kept.emplace(record.rest().begin(), record.rest().end());
  });
  if (!kept || journal.is_damaged()) throw InputError(path.string() + " is damaged");
  return kept;
} catch (const IoError& error) {  // no file at all
  throw InputError(error.what());
}

}  // namespace flatspeckle

#include "core/session/journal.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <iostream>
#include <optional>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include <zlib.h>

#include "core/error.h"
#include "core/session/session.h"

namespace flatspeckle {

namespace {

struct Head {
  /// checksum: CRC-32 of the length and the bytes of the block.
  std::uint32_t word = 0, checksum = 0;
  std::uint64_t length = 0;
};
static_assert(sizeof(Head) == 16);

// the letters "fblk", with which each block begins
constexpr std::uint32_t word_of_blocks = 0x6b6c6266;

std::uint32_t checksum_of(std::span<const std::byte> bytes) {
  const std::uint64_t length = bytes.size();
  const auto sum = crc32_z(0, reinterpret_cast<const unsigned char*>(&length), sizeof length);
  return static_cast<std::uint32_t>(
      crc32_z(sum, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::uint64_t size_of(int descriptor) {
  struct stat found {};
  return fstat(descriptor, &found) == 0 ? static_cast<std::uint64_t>(found.st_size) : 0;
}

bool read_at(int descriptor, std::uint64_t place, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const auto got = pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    place += static_cast<std::uint64_t>(got);
  }
  return true;
}

bool write_at(int descriptor, std::uint64_t place, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto put = pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    place += static_cast<std::uint64_t>(put);
  }
  return true;
}

/// Returns the bytes of the block at a position in the file; nullopt if there is no complete,
/// undamaged block.
std::optional<std::vector<std::byte>> block_at(int descriptor, std::uint64_t place,
                                               std::uint64_t size) {
  Head head;
  if (size < sizeof head || place > size - sizeof head ||
      !read_at(descriptor, place, std::as_writable_bytes(std::span(&head, 1))))
    return std::nullopt;
  if (head.word != word_of_blocks || head.length > size - place - sizeof head) return std::nullopt;
  std::vector<std::byte> bytes(head.length);
  if (!read_at(descriptor, place + sizeof head, bytes) || checksum_of(bytes) != head.checksum)
    return std::nullopt;
  return bytes;
}

/// Whether the rest of the file from this position on may be the beginning of one block.
bool is_torn(int descriptor, std::uint64_t place, std::uint64_t size) {
  Head head;
  if (size - place < sizeof head) return true;
  return read_at(descriptor, place, std::as_writable_bytes(std::span(&head, 1))) &&
         head.word == word_of_blocks && head.length > size - place - sizeof head;
}

}  // namespace

std::vector<std::byte> block_of(std::span<const std::byte> bytes) {
  const Head head{word_of_blocks, checksum_of(bytes), bytes.size()};
  std::vector<std::byte> whole(sizeof head + bytes.size());
  std::memcpy(whole.data(), &head, sizeof head);
  std::ranges::copy(bytes, whole.begin() + sizeof head);
  return whole;
}

BlockFile::BlockFile(std::filesystem::path path, Access access) : path_(std::move(path)) {
  const int flags = access == Access::read ? O_RDONLY : O_RDWR | O_CREAT;
  descriptor_ = open(path_.c_str(), flags | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail("opening");
}

BlockFile::~BlockFile() {
  close(descriptor_);
}

void BlockFile::fail(const char* doing) const {
  throw IoError(doing + (' ' + path_.string()) + " failed: " + std::strerror(errno));
}

BlockFile::Tail BlockFile::scan(
    const std::function<void(std::uint64_t place, std::span<const std::byte>)>& use) {
  const std::uint64_t size = size_of(descriptor_);
  end_ = 0;
  while (const auto block = block_at(descriptor_, end_, size)) {
    use(end_, *block);
    end_ += sizeof(Head) + block->size();
  }
  if (end_ == size) return Tail::none;
  return is_torn(descriptor_, end_, size) ? Tail::torn : Tail::damaged;
}

void BlockFile::cut() {
  if (ftruncate(descriptor_, static_cast<off_t>(end_)) != 0) fail("cutting");
}

std::uint64_t BlockFile::append(std::span<const std::byte> bytes) {
  const std::vector<std::byte> whole = block_of(bytes);
  if (!write_at(descriptor_, end_, whole)) {
    const int error = errno;
    const auto restored = ftruncate(descriptor_, static_cast<off_t>(end_));
    errno = restored == 0 ? error : errno;
    fail("writing");
  }
  return std::exchange(end_, end_ + whole.size());
}

std::vector<std::byte> BlockFile::read(std::uint64_t place) const {
  auto block = block_at(descriptor_, place, size_of(descriptor_));
  if (!block) throw IoError(path_.string() + " is damaged, or was changed by another process");
  return std::move(*block);
}

void BlockFile::sync() const {
  if (fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail("writing");
}

namespace fs = std::filesystem;

namespace {

constexpr char head_kind = 'h', kept_kind = 's';

std::vector<std::byte> with_kind(char kind, std::span<const std::byte> record) {
  std::vector<std::byte> block(1 + record.size(), std::byte(kind));
  std::ranges::copy(record, block.begin() + 1);
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
    throw InputError("resume: " + path.string() + " " + belongs_to_another(head.identity, whose) +
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
  if (!head_) throw InputError(path.string() + " is damaged, or was written by another version");
  if (head_->identity != identity)
    throw InputError(path.string() + ' ' + belongs_to_another(identity, whose));
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

/// Calls `use` for each record of this identity. Records that follow a JournalHead with another
/// identity are skipped.
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

std::string Journal::belongs_to_another(const std::string& identity,
                                        const std::string& whose) const {
  return "belongs to another " + whose + " (" + first_difference(head_->identity, identity) + ')';
}

void Journal::keep_damaged() const {
  const fs::path& path = file_.path();
  const auto place = free_backup(path);
  std::error_code failed;
  fs::copy_file(path, place, failed);
  std::cerr << "warning: " + path.string() + " is damaged after " + std::to_string(records_) +
                   " records; " +
                   (failed ? "the rest is computed again\n"
                           : "it is kept as " + place.filename().string() +
                                 ", and the rest is computed again\n");
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
} catch (const IoError& error) {  // the file cannot be opened or read
  throw InputError(error.what());
}

}  // namespace flatspeckle

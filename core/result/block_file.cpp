#include "core/result/block_file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include <zlib.h>

#include "core/error.h"

namespace flatspeckle {

namespace {

struct Head {
  std::uint32_t word = 0, checksum = 0;  ///< of the length and the bytes
  std::uint64_t length = 0;
};
static_assert(sizeof(Head) == 16);

constexpr std::uint32_t word_of_blocks = 0x6b6c6266;  // "fblk"

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

/// Nothing where there is no whole block.
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

/// Whether all from there on may be the beginning of one block.
bool is_torn(int descriptor, std::uint64_t place, std::uint64_t size) {
  Head head;
  if (size - place < sizeof head) return true;
  return read_at(descriptor, place, std::as_writable_bytes(std::span(&head, 1))) &&
         head.word == word_of_blocks && head.length > size - place - sizeof head;
}

}  // namespace

std::vector<std::byte> block_of(std::span<const std::byte> bytes) {
  const Head head{word_of_blocks, checksum_of(bytes), bytes.size()};
  const auto front = std::as_bytes(std::span(&head, 1));
  std::vector<std::byte> whole(front.begin(), front.end());
  whole.insert(whole.end(), bytes.begin(), bytes.end());
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

}  // namespace flatspeckle

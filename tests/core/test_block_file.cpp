#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/session/journal.h"

namespace flatspeckle::test_block_file {

namespace fs = std::filesystem;

namespace {

using Bytes = std::vector<std::byte>;
using Access = BlockFile::Access;
using Tail = BlockFile::Tail;

/// A temporary file of blocks of 0, 1, ... count - 1 bytes.
class Blocks {
 public:
  explicit Blocks(std::size_t count) {
    fs::remove(path);
    BlockFile file(path, Access::append);
    CHECK(file.scan([](std::uint64_t, std::span<const std::byte>) {}) == Tail::none);
    for (std::size_t i = 0; i < count; ++i) file.append(Bytes(i, std::byte(i)));
  }
  ~Blocks() { fs::remove(path); }
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;

  void change(std::uint64_t place) const {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(static_cast<std::streamoff>(place));
    const int was = file.get();
    file.seekp(static_cast<std::streamoff>(place));
    file.put(static_cast<char>(was ^ 1));
  }
  /// Returns the number of complete blocks and the type of the tail.
  std::pair<std::size_t, Tail> scanned() const {
    BlockFile file(path, Access::read);
    std::size_t count = 0;
    const Tail tail = file.scan([&](std::uint64_t place, std::span<const std::byte> bytes) {
      CHECK(Bytes(bytes.begin(), bytes.end()) == Bytes(count, std::byte(count)));
      CHECK(file.read(place) == Bytes(count, std::byte(count)));
      ++count;
    });
    return {count, tail};
  }

  fs::path path = fs::temp_directory_path() / ("blocks-" + std::to_string(getpid()));
};

}  // namespace

TEST_CASE("block file: blocks are read back, and more can be appended") {
  const Blocks blocks(9);
  CHECK(blocks.scanned() == std::pair{std::size_t{9}, Tail::none});
  {
    BlockFile file(blocks.path, Access::append);
    file.scan([](std::uint64_t, std::span<const std::byte>) {});
    file.append(Bytes(9, std::byte(9)));
    file.sync();
  }
  CHECK(blocks.scanned() == std::pair{std::size_t{10}, Tail::none});
}

TEST_CASE("block file: a truncated file contains the complete blocks before its end") {
  const Blocks blocks(6);
  for (auto size = fs::file_size(blocks.path); size > 0; --size) {
    fs::resize_file(blocks.path, size - 1);
    const auto [count, tail] = blocks.scanned();
    const std::size_t whole = 16 * count + count * (count - (count > 0)) / 2;
    CHECK(whole <= size - 1);
    CHECK(size - 1 < whole + 16 + count);
    CHECK(tail == (whole == size - 1 ? Tail::none : Tail::torn));
  }
}

TEST_CASE("block file: blocks before a changed byte are read, those after it are not") {
  constexpr std::size_t all = 6 * 16 + 15;
  for (std::size_t place = 0; place < all; ++place) {
    const Blocks blocks(6);
    blocks.change(place);
    const auto [count, tail] = blocks.scanned();
    const std::size_t whole = 16 * count + count * (count - (count > 0)) / 2;
    CHECK(whole <= place);
    CHECK(place < whole + 16 + count);
    CHECK(tail != Tail::none);
  }
}

TEST_CASE("block file: a torn tail can be removed") {
  const Blocks blocks(4);
  std::ofstream(blocks.path, std::ios::app) << "fblk and more that is no block";
  CHECK(blocks.scanned() == std::pair{std::size_t{4}, Tail::torn});
  std::ofstream(blocks.path, std::ios::app) << "zzz";
  BlockFile file(blocks.path, Access::append);
  file.scan([](std::uint64_t, std::span<const std::byte>) {});
  file.cut();
  CHECK(blocks.scanned() == std::pair{std::size_t{4}, Tail::none});
}

TEST_CASE("block file: missing or changed files are an IoError") {
  CHECK_THROWS_AS(BlockFile("/no/such/folder/blocks", Access::append), IoError);
  CHECK_THROWS_AS(BlockFile("/no/such/file", Access::read), IoError);
  const Blocks blocks(4);
  BlockFile file(blocks.path, Access::read);
  file.scan([](std::uint64_t, std::span<const std::byte>) {});
  blocks.change(16 + 16 + 16);  // in the header of the third
  CHECK_THROWS_AS(file.read(33), IoError);
}

}  // namespace flatspeckle::test_block_file

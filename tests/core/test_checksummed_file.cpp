#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

#include <doctest/doctest.h>

#include "core/result/guarded_read.h"
#include "core/result/result_file.h"
#include "core/result/result_reader.h"

namespace flatspeckle::test_checksummed_file {

namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::byte>;

constexpr std::size_t checksum_size = 16;

/// A temporary folder.
class Folder {
 public:
  Folder() { fs::create_directory(path_); }
  ~Folder() { fs::remove_all(path_); }
  fs::path file() const { return path_ / "file"; }

 private:
  fs::path path_ =
      fs::temp_directory_path() / ("test_checksummed_file-" + std::to_string(::getpid()));
};

Bytes some_bytes(std::size_t length) {
  Bytes bytes(length);
  for (std::size_t i = 0; i < length; ++i) bytes[i] = std::byte(17 * i + i / 7);
  return bytes;
}

Bytes checksummed(Bytes bytes) {
  append_checksum(bytes);
  return bytes;
}

void put(const fs::path& path, const Bytes& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

/// Returns is_checksummed() of a file with these bytes.
bool is_checksummed_file_of(const Bytes& bytes) {
  const Folder folder;
  put(folder.file(), bytes);
  return is_checksummed(folder.file());
}

}  // namespace

TEST_CASE("checksum: 16 bytes are appended, the others are unchanged") {
  for (std::size_t length : {0, 1, 15, 16, 17, 1000}) {
    const Bytes plain = some_bytes(length), whole = checksummed(plain);
    REQUIRE(whole.size() == length + checksum_size);
    CHECK(std::equal(plain.begin(), plain.end(), whole.begin()));
    CHECK(is_checksummed_file_of(whole));
    CHECK_FALSE(is_checksummed_file_of(plain));
  }
}

TEST_CASE("checksum: agrees with the standard CRC-32") {
  Bytes bytes;
  for (char c : std::string("123456789")) bytes.push_back(std::byte(c));
  append_checksum(bytes);
  const std::string expected("seal\x26\x39\xf4\xcb\x09\0\0\0\0\0\0\0", checksum_size);
  for (std::size_t i = 0; i < checksum_size; ++i)
    CHECK(std::to_integer<int>(bytes[9 + i]) == static_cast<unsigned char>(expected[i]));
}

TEST_CASE("checksum: every flipped bit is detected, also in the checksum") {
  const Folder folder;
  const Bytes whole = checksummed(some_bytes(100));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes flipped = whole;
    flipped[bit / 8] ^= std::byte(1 << bit % 8);
    put(folder.file(), flipped);
    CHECK_FALSE(is_checksummed(folder.file()));
  }
}

TEST_CASE("checksum: truncated files and added, missing and swapped bytes are detected") {
  const Bytes whole = checksummed(some_bytes(100));
  for (std::size_t length = 0; length < whole.size(); ++length)
    CHECK_FALSE(
        is_checksummed_file_of(Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(length))));
  Bytes longer = whole;
  longer.push_back(std::byte{});
  CHECK_FALSE(is_checksummed_file_of(longer));
  Bytes lost = whole;
  lost.erase(lost.begin() + 50);
  CHECK_FALSE(is_checksummed_file_of(lost));
  Bytes swapped = whole;
  std::swap(swapped[10], swapped[11]);
  CHECK_FALSE(is_checksummed_file_of(swapped));
  CHECK_FALSE(is_checksummed_file_of(Bytes(whole.size())));
}

TEST_CASE("checksum: unreadable files are not checksummed") {
  const Folder folder;
  CHECK_FALSE(is_checksummed(folder.file()));
  CHECK_FALSE(is_checksummed(folder.file() / "below"));
  fs::create_directory(folder.file());
  CHECK_FALSE(is_checksummed(folder.file()));
}

TEST_CASE("checksum: a checksummed result file is readable and replaces an old file") {
  const Folder folder;
  put(folder.file(), some_bytes(100'000));
  ResultFile file(folder.file());
  file.attribute("/", "name", "value");
  file.dataset("numbers", std::vector{1.0, 2.0, 3.0}, {std::size_t{3}}, "1", "");
  file.commit_checksummed(Durable::no);
  CHECK(is_checksummed(folder.file()));
  const ResultReader reader(folder.file());
  CHECK(reader.attribute<std::string>("/", "name") == "value");
  CHECK(reader.dataset<double>("numbers") == std::vector{1.0, 2.0, 3.0});
}

TEST_CASE("checksum: a result file without checksum is not checksummed") {
  const Folder folder;
  ResultFile file(folder.file());
  file.attribute("/", "name", "value");
  file.commit();
  CHECK_FALSE(is_checksummed(folder.file()));
}

}  // namespace flatspeckle::test_checksummed_file

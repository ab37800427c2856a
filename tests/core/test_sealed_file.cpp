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

namespace flatspeckle::test_sealed_file {

namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::byte>;

constexpr std::size_t seal_size = 16;

/// A folder that goes with its test.
class Folder {
 public:
  Folder() { fs::create_directory(path_); }
  ~Folder() { fs::remove_all(path_); }
  fs::path file() const { return path_ / "file"; }

 private:
  fs::path path_ = fs::temp_directory_path() / ("test_sealed_file-" + std::to_string(::getpid()));
};

Bytes some_bytes(std::size_t length) {
  Bytes bytes(length);
  for (std::size_t i = 0; i < length; ++i) bytes[i] = std::byte(17 * i + i / 7);
  return bytes;
}

Bytes sealed(Bytes bytes) {
  seal(bytes);
  return bytes;
}

void put(const fs::path& path, const Bytes& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

/// What is_sealed says of a file of these bytes.
bool is_sealed_file_of(const Bytes& bytes) {
  const Folder folder;
  put(folder.file(), bytes);
  return is_sealed(folder.file());
}

}  // namespace

TEST_CASE("a seal is 16 bytes behind the others, which stay as they are") {
  for (std::size_t length : {0, 1, 15, 16, 17, 1000}) {
    const Bytes plain = some_bytes(length), whole = sealed(plain);
    REQUIRE(whole.size() == length + seal_size);
    CHECK(std::equal(plain.begin(), plain.end(), whole.begin()));
    CHECK(is_sealed_file_of(whole));
    CHECK_FALSE(is_sealed_file_of(plain));
  }
}

TEST_CASE("the checksum is the CRC-32 that other programs know") {
  Bytes bytes;
  for (char c : std::string("123456789")) bytes.push_back(std::byte(c));
  seal(bytes);
  const std::string expected("seal\x26\x39\xf4\xcb\x09\0\0\0\0\0\0\0", seal_size);
  for (std::size_t i = 0; i < seal_size; ++i)
    CHECK(std::to_integer<int>(bytes[9 + i]) == static_cast<unsigned char>(expected[i]));
}

TEST_CASE("every flipped bit is noticed, those of the seal too") {
  const Folder folder;
  const Bytes whole = sealed(some_bytes(100));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes flipped = whole;
    flipped[bit / 8] ^= std::byte(1 << bit % 8);
    put(folder.file(), flipped);
    CHECK_FALSE(is_sealed(folder.file()));
  }
}

TEST_CASE("every cut is noticed, and bytes too many, lost and swapped") {
  const Bytes whole = sealed(some_bytes(100));
  for (std::size_t length = 0; length < whole.size(); ++length)
    CHECK_FALSE(is_sealed_file_of(Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(length))));
  Bytes longer = whole;
  longer.push_back(std::byte{});
  CHECK_FALSE(is_sealed_file_of(longer));
  Bytes lost = whole;
  lost.erase(lost.begin() + 50);
  CHECK_FALSE(is_sealed_file_of(lost));
  Bytes swapped = whole;
  std::swap(swapped[10], swapped[11]);
  CHECK_FALSE(is_sealed_file_of(swapped));
  CHECK_FALSE(is_sealed_file_of(Bytes(whole.size())));
}

TEST_CASE("what cannot be read is not sealed") {
  const Folder folder;
  CHECK_FALSE(is_sealed(folder.file()));
  CHECK_FALSE(is_sealed(folder.file() / "below"));
  fs::create_directory(folder.file());
  CHECK_FALSE(is_sealed(folder.file()));
}

TEST_CASE("a sealed result file is read as any other, and replaces what was there") {
  const Folder folder;
  put(folder.file(), some_bytes(100'000));
  ResultFile file(folder.file());
  file.attribute("/", "name", "value");
  file.dataset("numbers", std::vector{1.0, 2.0, 3.0}, {std::size_t{3}}, "1", "");
  file.commit_sealed(Durable::no);
  CHECK(is_sealed(folder.file()));
  const ResultReader reader(folder.file());
  CHECK(reader.attribute<std::string>("/", "name") == "value");
  CHECK(reader.dataset<double>("numbers") == std::vector{1.0, 2.0, 3.0});
}

TEST_CASE("a result file without a seal is not sealed") {
  const Folder folder;
  ResultFile file(folder.file());
  file.attribute("/", "name", "value");
  file.commit();
  CHECK_FALSE(is_sealed(folder.file()));
}

}  // namespace flatspeckle::test_sealed_file

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/keys/csv.h"

namespace flatspeckle::test_csv {

namespace {

/// A file with this text, gone at the end of its scope.
class TextFile {
 public:
  explicit TextFile(const std::string& text) {
    std::string pattern = (std::filesystem::temp_directory_path() / "flatspeckle-XXXXXX").string();
    const int descriptor = mkstemp(pattern.data());
    REQUIRE(descriptor >= 0);
    ::close(descriptor);
    path_ = pattern;
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TextFile() { std::filesystem::remove(path_); }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

Table table_of(const std::string& text) {
  return read_csv(TextFile(text).path());
}

/// The complaint about a file with this text, without its path.
std::string complaint(const std::string& text) {
  const TextFile file(text);
  try {
    read_csv(file.path());
  } catch (const InputError& error) {
    const std::string line = error.what(), path = file.path().string();
    REQUIRE(line.starts_with(path));
    return line.substr(path.size());
  }
  return "none";
}

std::vector<double> column(const Table& table, const std::string& name) {
  const auto values = table.column(name);
  return {values.begin(), values.end()};
}

}  // namespace

TEST_CASE("columns are read by name") {
  const Table table = table_of("x,z,radius\n1,-2.5,3e-2\n0.1,+4,1E3\n");
  CHECK(table.names() == std::vector<std::string>{"x", "z", "radius"});
  CHECK(table.rows() == 2);
  CHECK(column(table, "x") == std::vector{1, 0.1});
  CHECK(column(table, "z") == std::vector{-2.5, 4.0});
  CHECK(column(table, "radius") == std::vector{0.03, 1000.0});
  CHECK(table.has("z"));
  CHECK_FALSE(table.has("y"));
  CHECK_THROWS_WITH_AS(table.column("y"), doctest::Contains("no column \"y\" among x, z, radius"),
                       InputError);
}

TEST_CASE("spaces, CRLF, comments, blank lines and a missing last newline are allowed") {
  const Table table =
      table_of("# from a bench\r\n\r\n x ,\tz\r\n 1 , 2 \r\n# half\r\n3,4\r\n\r\n\n");
  CHECK(column(table, "x") == std::vector<double>{1, 3});
  CHECK(column(table, "z") == std::vector<double>{2, 4});
  CHECK(column(table_of("x\n5"), "x") == std::vector<double>{5});
  CHECK(table_of("x,z\n").rows() == 0);
}

TEST_CASE("a byte order mark is no part of the first name") {
  CHECK(table_of("\xEF\xBB\xBFx,z\n1,2\n").names() == std::vector<std::string>{"x", "z"});
  CHECK(complaint("\xEF\xBB\xBF") == ": empty, expected a line of column names");
}

TEST_CASE("numbers are read exactly") {
  CHECK(column(table_of("x\n0.1\n-1.7976931348623157e308\n"), "x") ==
        std::vector{0.1, -1.7976931348623157e308});
}

TEST_CASE("tables of given columns hold nothing else, and no numbers out of bounds") {
  const TextFile file("x,z\n1,2\n-1e51,3\n");
  CHECK_THROWS_WITH_AS(read_csv(file.path(), {"x", "y"}),
                       doctest::Contains("column \"z\": must be one of x, y"), InputError);
  CHECK_THROWS_WITH_AS(read_csv(file.path(), {"z", "x"}), doctest::Contains("x = -1e+51"),
                       InputError);
  const TextFile sound("z,x\n1,-1e50\n");
  CHECK(column(read_csv(sound.path(), {"x", "y", "z"}), "x") == std::vector{-1e50});
}

TEST_CASE("what is wrong is told with file and line") {
  CHECK(complaint("") == ": empty, expected a line of column names");
  CHECK(complaint("# only\n\n") == ": empty, expected a line of column names");
  CHECK(complaint("x,z\n1,2\n\n3\n") == ", line 4: expected 2 fields, found 1");
  CHECK(complaint("x,z\n1,2,3\n") == ", line 2: expected 2 fields, found 3");
  CHECK(complaint("x,z\n1,2,\n") == ", line 2: expected 2 fields, found 3");
  CHECK(complaint("x,z,x\n") == ", line 1: column \"x\" appears twice");
  CHECK(complaint("x,,z\n") == ", line 1: a column has no name");
  for (const char* bad : {"nan", "inf", "-inf", "1e999", "one", "1.5m", "", "1 2", "+-1", "0x10"})
    CHECK(complaint("z,x\n1," + std::string(bad) + "\n") ==
          ", line 2: x = \"" + std::string(bad) + "\": must be a finite number");
}

TEST_CASE("files that cannot be read are bad input") {
  CHECK_THROWS_AS(read_csv("no/such/file.csv"), InputError);
  CHECK_THROWS_AS(read_csv(std::filesystem::temp_directory_path()), InputError);
}

}  // namespace flatspeckle::test_csv

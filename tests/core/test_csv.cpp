#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <unistd.h>
#include <vector>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/keys/csv.h"

namespace flatspeckle::test_csv {

namespace {

/// A temporary file with this text.
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

/// Returns the error message about a file with this text, without its path.
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

TEST_CASE("csv: columns are read by name") {
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

TEST_CASE("csv: spaces, CRLF, comments, blank lines and a missing last newline are allowed") {
  const Table table =
      table_of("# from a bench\r\n\r\n x ,\tz\r\n 1 , 2 \r\n# half\r\n3,4\r\n\r\n\n");
  CHECK(column(table, "x") == std::vector<double>{1, 3});
  CHECK(column(table, "z") == std::vector<double>{2, 4});
  CHECK(column(table_of("x\n5"), "x") == std::vector<double>{5});
  CHECK(table_of("x,z\n").rows() == 0);
}

TEST_CASE("csv: a byte order mark is not part of the first name") {
  CHECK(table_of("\xEF\xBB\xBFx,z\n1,2\n").names() == std::vector<std::string>{"x", "z"});
  CHECK(complaint("\xEF\xBB\xBF") == ": is empty; expected a line of column names");
}

TEST_CASE("csv: numbers are read exactly") {
  CHECK(column(table_of("x\n0.1\n-1.7976931348623157e308\n"), "x") ==
        std::vector{0.1, -1.7976931348623157e308});
}

TEST_CASE("csv: unknown columns and numbers out of bounds are rejected") {
  const TextFile file("x,z\n1,2\n-1e51,3\n");
  CHECK_THROWS_WITH_AS(read_key_table("places", file.path(), {"x", "y"}),
                       doctest::Contains("column \"z\": must be one of x, y"), InputError);
  CHECK_THROWS_WITH_AS(read_key_table("places", file.path(), {"z", "x"}),
                       doctest::Contains("x = -1e+51"), InputError);
  const TextFile sound("z,x\n1,-1e50\n");
  CHECK(column(read_key_table("places", sound.path(), {"x", "y", "z"}), "x") == std::vector{-1e50});
}

TEST_CASE("csv: error messages contain file and line") {
  CHECK(complaint("") == ": is empty; expected a line of column names");
  CHECK(complaint("# only\n\n") == ": is empty; expected a line of column names");
  CHECK(complaint("x,z\n1,2\n\n3\n") ==
        ", line 4: expected 2 fields, found 1 (fields must be separated by commas, as the names "
        "are)");
  CHECK(complaint("x,z\n1,2,3\n") == ", line 2: expected 2 fields, found 3");
  CHECK(complaint("x,z\n1,2,\n") == ", line 2: expected 2 fields, found 3");
  CHECK(complaint("x,z,x\n") == ", line 1: column \"x\" appears twice");
  CHECK(complaint("x,,z\n") == ", line 1: a column has no name");
  for (const char* bad : {"nan", "inf", "-inf", "1e999", "one", "1.5m", "", "1 2", "+-1", "0x10"})
    CHECK(complaint("z,x\n1," + std::string(bad) + "\n") ==
          ", line 2: x = \"" + std::string(bad) + "\": must be a finite number");
}

TEST_CASE("csv: formats of spreadsheets and instruments agree with the plain table") {
  const std::string plain = "x,z,radius\n0,-0.5,0.3\n0.5,2,1000\n";
  for (const std::string& text : {
           std::string("\"x\",\"z\",\"radius\"\n0,-0.5,0.3\n0.5,2,1000\n"),
           std::string("x,z,radius\n\"0\",\"-0.5\", \"0.3\" \n\"0.5\",\"2\",\"1000\"\n"),
           std::string("x;z;radius\n0;-0.5;0.3\n0.5;2;1000\n"),
           std::string("x;z;radius\n0;-0,5;0,3\n0,5;2;1000\n"),
           std::string("\"x\";\"z\";\"radius\"\n\"0\";\"-0,5\";\"0,3\"\n0,5;2;1000\n"),
           std::string("x\tz\tradius\n0\t-0,5\t0,3\n0,5\t2\t1_000\n"),
           std::string("x\tz\tradius\r0\t-0.5\t0.3\r0.5\t2\t1e3\r"),
           std::string("sep=;\r\nx;z;radius\r\n0;-0,5;0,3\r\n0,5;2;1000\r\n"),
           std::string("\xEF\xBB\xBF\"sep=|\"\r\nx|z|radius\r\n0|-0.5|0.3\r\n0.5|2|1000\r\n"),
           std::string("x,z,radius,,\r\n0,-0.5,0.3,,\r\n0.5,2,1000\r\n,,,,\r\n"),
           std::string("x z radius\n 0  -0.5 0.3\n0.5\t2   1000 \n"),
           std::string("# x,z,radius\n0,-0.5,0.3\n0.5,2,1000\n"),
           std::string("% made by hand\n#x z radius\n0 -0.5 0.3\n0.5 2 1000\n"),
           std::string("x,z,radius\n0,\xE2\x88\x92"
                       "0.5,0.3\n0.5,\xC2\xA0"
                       "2,1000\n"),
       }) {
    CAPTURE(text);
    const Table table = table_of(text), expected = table_of(plain);
    CHECK(table.names() == expected.names());
    for (const std::string& name : expected.names())
      CHECK(column(table, name) == column(expected, name));
  }
}

TEST_CASE("csv: UTF-16 is read with and without a byte order mark") {
  const std::string plain = "x,z\r\n0.5,-2\r\n";
  for (const bool big : {false, true})
    for (const bool marked : {false, true}) {
      std::string text = !marked ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
      for (const char letter : plain)
        text += big ? std::string{'\0', letter} : std::string{letter, '\0'};
      CHECK(column(table_of(text), "x") == std::vector{0.5});
      CHECK(column(table_of(text), "z") == std::vector{-2.0});
    }
}

TEST_CASE("csv: columns of angles may be in degrees") {
  const double degree = std::numbers::pi / 180;
  const Table table = table_of("light_angle_deg,tilt,radius_deg\n30,0.5deg,7\n-90,pi/2,8\n");
  CHECK(table.names() == std::vector<std::string>{"light_angle", "tilt", "radius_deg"});
  CHECK(column(table, "light_angle") == std::vector{30 * degree, -90 * degree});
  CHECK(column(table, "tilt") == std::vector{0.5 * degree, std::numbers::pi / 2});
  CHECK(column(table, "radius_deg") == std::vector{7.0, 8.0});
  CHECK(complaint("angle,angle_deg\n1,2\n") == ", line 1: column \"angle\" appears twice");
  CHECK(complaint("x\n30deg\n") == ", line 2: x = \"30deg\": must be a finite number");
}

TEST_CASE("csv: ambiguous commas are rejected") {
  CHECK(complaint("x\tz\n1,234\t5\n") ==
        ", line 2: \"1,234\": the comma may be a decimal or a thousands separator; must be written "
        "with a decimal point");
  CHECK(complaint("x,z\n\"1,234\",5\n").find("thousands") != std::string::npos);
  CHECK(column(table_of("x\tz\n1,234\t0,5\n"), "x") == std::vector{1.234});
  CHECK(column(table_of("x;z\n1,234;5\n"), "x") == std::vector{1.234});
  CHECK(complaint("x;z\n0,5;1\n1.5;2\n") ==
        ", line 2: \"0,5\" has a decimal comma, but line 3 has a decimal point: use only one of "
        "the two");
  CHECK(complaint("x;z\n1.234,5;2\n") == ", line 2: x = \"1.234,5\": must be a finite number");
  CHECK(complaint("x,z\n0,5,1,5\n") ==
        ", line 2: expected 2 fields, found 4 (with decimal commas, fields must be separated by "
        ";)");
}

TEST_CASE("csv: files that are not tables are rejected with the reason") {
  CHECK(complaint("0,1\n2,3\n") ==
        ", line 1: must be a line of column names, but contains numbers");
  CHECK(complaint("# by hand\n0,1\n").find("line of column names") != std::string::npos);
  CHECK(complaint("x,z\n\"0,1\n") ==
        ", line 2: quotation marks must be around whole fields, on one line");
  CHECK(complaint("x,z\n0\"1\",1\n").find("quotation marks") != std::string::npos);
  CHECK(complaint("x,z\n1_,1\n") == ", line 2: x = \"1_\": must be a finite number");
  CHECK(complaint("x,z,\n0,1,2\n") == ", line 2: expected 2 fields, found 3");
  CHECK(complaint("sep=:\nx:z\n0:1\n").find("sep=:: fields must be") != std::string::npos);
  for (const std::string& binary :
       {std::string("PK\x03\x04\x14\0\x06", 7), std::string("x,z\n0,\0", 7)})
    CHECK(complaint(binary).find("is not a text file") != std::string::npos);
}

TEST_CASE("csv: messages about key tables begin with the key; empty tables are rejected") {
  const TextFile file("x,z\n");
  CHECK_THROWS_WITH_AS(read_key_table("rays", file.path()),
                       ("rays = " + file.path().string() +
                        ": must have at least one row; it contains only column names")
                           .c_str(),
                       InputError);
}

TEST_CASE("csv: rows without column names must have equal length") {
  CHECK(read_rows(TextFile("1,2\n3,4,\n").path()) ==
        std::vector<std::vector<double>>{{1, 2}, {3, 4}});
  CHECK(read_rows(TextFile("0,5\t2\n3\t4\n").path()) ==
        std::vector<std::vector<double>>{{0.5, 2}, {3, 4}});
  CHECK_THROWS_WITH_AS(read_rows(TextFile("1 2\n3\n").path()),
                       doctest::Contains("line 2: has 1 numbers, but the first row has 2"),
                       InputError);
}

TEST_CASE("csv: unreadable files are an InputError") {
  CHECK_THROWS_AS(read_csv("no/such/file.csv"), InputError);
  CHECK_THROWS_AS(read_csv(std::filesystem::temp_directory_path()), InputError);
}

}  // namespace flatspeckle::test_csv

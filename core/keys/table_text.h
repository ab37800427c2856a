#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace flatspeckle {

/// Throws InputError naming the file.
std::string file_bytes(const std::filesystem::path& path);

/// A line of a table and its number in the file.
struct TableLine {
  std::size_t number;
  std::string text;
};

/// The text of a table, whichever program wrote it: UTF-8 or UTF-16, with or without a byte order
/// mark; lines that end with LF, CRLF or CR; fields between commas, semicolons, tabs or spaces, in
/// quotation marks or without; a first line sep=; that names the character between fields. Blank
/// lines and comments, which begin with # or %, are left out.
class TableText {
 public:
  /// named: the first line has the names of the columns. Where numbers stand there, the comment
  /// before them has the names. Throws InputError naming the file.
  TableText(const std::filesystem::path& path, bool named);

  /// With the names first, if there are names.
  const std::vector<TableLine>& lines() const { return lines_; }
  /// Throws InputError where quotation marks do not fit together.
  std::vector<std::string> fields(const TableLine& line) const;
  char separator() const { return separator_; }
  /// Throws InputError naming file and line.
  [[noreturn]] void fail(const TableLine& line, const std::string& what) const;

 private:
  void split_lines(std::string_view text);
  void take_separator();
  void find_separator(bool named);
  void take_names();

  std::string path_;
  std::vector<TableLine> lines_;
  TableLine comment_{0, ""};  ///< the last before the first line
  char separator_ = '\0';
};

}  // namespace flatspeckle

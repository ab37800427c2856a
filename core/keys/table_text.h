#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace flatspeckle {

/// Returns the content of a file. Throws InputError if the file cannot be read.
std::string file_bytes(const std::filesystem::path& path);

/// A line of a table and its number in the file.
struct TableLine {
  std::size_t number;
  std::string text;
};

/// Text of a table as common programs write it: UTF-8 or UTF-16, with or without a byte order mark;
/// lines that end with LF, CRLF or CR; fields separated by commas, semicolons, tabs or spaces,
/// quoted or not; an optional first line sep=; that sets the separator. Blank lines and comments,
/// which begin with # or %, are skipped.
class TableText {
 public:
  /// named: whether the columns have names. The names are in the first line or, if the first line
  /// contains numbers, in the comment above the first line. Throws InputError; the message names
  /// the file.
  TableText(const std::filesystem::path& path, bool named);

  /// Returns the lines of the table. If the columns have names, the names are the first line.
  const std::vector<TableLine>& lines() const { return lines_; }
  /// Splits a line into fields. Throws InputError for unmatched quotation marks.
  std::vector<std::string> fields(const TableLine& line) const;
  char separator() const { return separator_; }
  /// Throws InputError with a message that begins with file and line.
  [[noreturn]] void fail(const TableLine& line, const std::string& what) const;

 private:
  void split_lines(std::string_view text);
  void take_separator();
  void find_separator(bool named);
  void take_names();

  std::string path_;
  std::vector<TableLine> lines_;
  TableLine comment_{0, ""};  ///< last comment above the first line of the table
  char separator_ = '\0';
};

}  // namespace flatspeckle
